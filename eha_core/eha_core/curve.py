"""A curve through evenly spaced knots: the form in which an unknown law is recovered and simulated."""

from __future__ import annotations

from eha_core.compiled import called
from eha_core.parameter import Parameter

KNOTS = 25
SOURCE = "recovered from a recording"


def knot_parameters(symbol: str, unit: str, largest: float, meaning: str) -> tuple[Parameter, ...]:
    """The curve's rows: the range it was seen over, and its value at each knot."""
    return (
        Parameter(
            name="lower",
            symbol="z_0",
            unit="-",
            nominal=-1.0,
            lower=-1e9,
            upper=1e9,
            meaning="where the first knot stands, in the variable's unit",
            source=SOURCE,
        ),
        Parameter(
            name="upper",
            symbol="z_n",
            unit="-",
            nominal=1.0,
            lower=-1e9,
            upper=1e9,
            meaning="where the last knot stands, in the variable's unit",
            source=SOURCE,
        ),
        *(
            Parameter(
                name=f"knot_{k:02d}",
                symbol=f"{symbol}_{k}",
                unit=unit,
                nominal=0.0,
                lower=-largest,
                upper=largest,
                meaning=f"{meaning} at knot {k}",
                source=SOURCE,
                switches=True,
            )
            for k in range(KNOTS)
        ),
    )


@called
def curve_value(at, lower, upper, knots):
    """Value and slope of the piecewise linear curve; beyond its ends it goes on at the end knots' values."""
    width = (upper - lower) / (KNOTS - 1)
    place = (at - lower) / width
    if not place > 0.0:  # so written, it also holds for the nan of a curve without width
        return knots[0], 0.0
    if place >= KNOTS - 1:
        return knots[KNOTS - 1], 0.0
    left = int(place)
    share = place - left
    return (1.0 - share) * knots[left] + share * knots[left + 1], (knots[left + 1] - knots[left]) / width
