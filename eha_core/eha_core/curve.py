"""A curve through evenly spaced knots: the form in which an unknown law is recovered and simulated."""

from __future__ import annotations

from eha_core.compiled import called
from eha_core.parameter import Parameter

KNOTS = 25
SOURCE = "recovered from a recording"


def knot_parameters(symbol: str, unit: str, largest: float, meaning: str) -> tuple[Parameter, ...]:
    """The curve's rows: the range it was seen over, and its value at each knot."""
    return (
        Parameter("lower", "z_0", "-", -1.0, -1e9, 1e9, "where the first knot stands, in the variable's unit", SOURCE),
        Parameter("upper", "z_n", "-", 1.0, -1e9, 1e9, "where the last knot stands, in the variable's unit", SOURCE),
        *(
            Parameter(f"knot_{k:02d}", f"{symbol}_{k}", unit, 0.0, -largest, largest, f"{meaning} at knot {k}", SOURCE,
                      switches=True)
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
