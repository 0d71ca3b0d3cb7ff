"""The leakage curve: the supply's flow at blocked ports over the command, largest about null.

The peak is found by the shape that fits best of three: exponential, Gaussian and Lorentzian, each over a constant flow
far from null (that of a pilot stage). Where flow curve, pressure drop and supply pressure are known, the law of the
effect `valve_null_leakage` is fitted as well, with the blocked ports' pressures in balance:

    K o y + g y^2 = g (D - y^2), y = sqrt(P_s - P_A), g = G exp(-|x| / w), D = P_s - P_r, and Q = K o y + g D.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eha_core.errors import EhaError
from eha_core.valve_curves.flow import LEAST_EXPLAINED, require_points
from eha_core.valve_curves.regression import DECISIVE, Regression, criterion_gain, explained, regress
from eha_core.valve_curves.result import Array, Curve, CurveFit, Value
from eha_core.valve_curves.travel import behind_play, travel_of

_SHAPES: dict[str, Callable[[Array], Array]] = {
    "exponential": lambda away: np.exp(-np.abs(away)),
    "Gaussian": lambda away: np.exp(-(away**2)),
    "Lorentzian": lambda away: 1.0 / (1.0 + away**2),
}
_WIDTHS = (0.03, 0.1, 0.3)
"""Initial widths, in parts of the largest command."""


@dataclass(frozen=True)
class Orifices:
    """What the flow curve and the test stand say of the ports.

    Attributes:
        gain: K of Q = K o sqrt(dp) [m^3/s per unit of the command and root of a pascal].
        overlap: half of the dead zone [unit of the command].
        supply: supply pressure above the return line's [Pa].
    """

    gain: float
    overlap: float
    supply: float


def fit_leakage(curve: Curve) -> CurveFit:
    """The figures of a leakage curve.

    Raises:
        EhaError: too few points, no leakage, or no peak within the range of the command.
    """
    require_points(curve)
    full = float(np.max(curve.response))
    if full <= 0.0:
        raise EhaError(f"{curve.source}: the leakage is nowhere positive; check the column and the meter's sign")
    largest = float(np.max(np.abs(curve.command)))
    leakage = curve.response / full
    best, fitted = _best_shape(curve, largest, leakage)
    place = float(fitted.values[0])
    least = float(np.min(curve.command)) / largest, float(np.max(curve.command)) / largest
    is_peak = fitted.values[1] > 0.0 and least[0] < place < least[1] and explained(fitted, leakage) > LEAST_EXPLAINED
    if not is_peak:
        raise EhaError(
            f"{curve.source}: the leakage has no peak within {curve.command.min():.4g} to {curve.command.max():.4g}"
            f" {curve.unit}; measure through null to both sides"
        )
    peak, reach = fitted.of(lambda values: float(values[1] + values[3]))
    null, null_reach = fitted.of(lambda values: float(values[0]))
    floor, floor_reach = fitted.of(lambda values: float(values[3]))
    values = [
        Value("null_shift", null * largest, null_reach * largest, curve.unit),
        Value("null_leakage", peak * full, reach * full, "m^3/s"),
        Value("leakage_far_from_null", floor * full, floor_reach * full, "m^3/s"),
    ]
    grid = np.linspace(curve.command.min(), curve.command.max(), 400)
    law = _law(best, grid / largest, np.zeros(grid.size))
    line = (f"{best} peak", grid, law(fitted.values) * full)
    remarks = list(curve.remarks)
    if fitted.values.size > 4:
        width, width_reach = fitted.of(lambda values: 2.0 * float(values[4]))
        values.insert(1, Value("hysteresis", width * largest, width_reach * largest, curve.unit))
    return CurveFit(curve, {row.name: row for row in values}, (line,), tuple(remarks))


def fit_lands(fit: CurveFit, orifices: Orifices) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """Conductance of each land at null [m^3/(s Pa)] and width [unit of the command], each with half of its 95 %
    interval, by the law of `valve_null_leakage`; None where a plain peak fits decisively better."""
    curve = fit.curve
    full, largest = float(np.max(curve.response)), float(np.max(np.abs(curve.command)))
    command, leakage = curve.command / largest, curve.response / full
    travel = travel_of(command)
    null = fit.values["null_shift"].value / largest
    half = 0.5 * fit.values["hysteresis"].value / largest if "hysteresis" in fit.values else 0.0
    span = orifices.supply / full

    def law(values: Array) -> Array:
        spool = behind_play(command, travel, half) - values[0]
        lands = values[1] / orifices.supply * np.exp(-np.abs(spool) / values[2])
        opening = np.maximum(np.abs(spool) * largest - max(orifices.overlap, 0.0), 0.0)
        flow = orifices.gain * opening / full
        root = (np.sqrt(flow**2 + 8.0 * lands**2 * orifices.supply) - flow) / np.maximum(4.0 * lands, 1e-300)
        drawn: Array = flow * root + lands * orifices.supply + values[3]
        return drawn

    floor = fit.values["leakage_far_from_null"].value / full
    trials = [
        regress(law, leakage, [null, height, width, floor], [-1.0, 1e-6, 1e-4, -1.0], [1.0, 10.0, 10.0, 1.0])
        for width in _WIDTHS for height in (0.5, 1.0)
    ]  # fmt: skip
    fitted = min(trials, key=lambda trial: trial.deviation)
    _, plain = _best_shape(curve, largest, leakage)
    if explained(fitted, leakage) < LEAST_EXPLAINED or criterion_gain(fitted, plain) > DECISIVE:
        return None
    conductance, reach = fitted.of(lambda values: float(values[1]) / span)
    width, width_reach = fitted.of(lambda values: float(values[2]) * largest)
    return (conductance, reach), (width, width_reach)


def _law(shape: str, command: Array, direction: Array) -> Callable[[Array], Array]:
    """The leakage by place, height, width, floor and, where that is a fifth value, half of the hysteresis."""

    def law(values: Array) -> Array:
        behind = direction * values[4] if values.size > 4 else 0.0
        leakage: Array = values[1] * _SHAPES[shape]((command - values[0] - behind) / values[2]) + values[3]
        return leakage

    return law


def _best_shape(curve: Curve, largest: float, leakage: Array) -> tuple[str, Regression]:
    """The shape that fits best, with place, height, width, floor and, measured both ways, half of the hysteresis."""
    command = curve.command / largest
    travel = travel_of(command)
    place, floor = float(command[np.argmax(leakage)]), float(np.min(leakage))
    extra = [0.0] if travel.is_both_ways else []
    found: list[tuple[str, Regression]] = []
    for shape in _SHAPES:
        law = _law(shape, command, travel.direction)
        for width in _WIDTHS:
            start = [place, 1.0 - floor, width, floor, *extra]
            lower = [-1.0, -np.inf, 1e-4, -1.0, *([-1.0] if extra else [])]
            upper = [1.0, np.inf, 10.0, 1.0, *([1.0] if extra else [])]
            found.append((shape, regress(law, leakage, start, lower, upper)))
    return min(found, key=lambda row: row[1].deviation)
