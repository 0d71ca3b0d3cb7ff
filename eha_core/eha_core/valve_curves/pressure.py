"""The pressure gain curve: the slope of the load pressure at blocked ports, and the command at which it is zero.

The gain is the mean slope between -40 % and +40 % of the largest load pressure, as test standards of servo valves
define it (SAE ARP490, ISO 10770-1).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eha_core.errors import EhaError
from eha_core.valve_curves.flow import require_points
from eha_core.valve_curves.regression import regress
from eha_core.valve_curves.result import Array, Curve, CurveFit, Value
from eha_core.valve_curves.travel import Travel, behind_play, travel_of

RANGE = 0.4
"""Share of the largest load pressure up to which the slope counts (SAE ARP490, ISO 10770-1)."""

FEWEST_INSIDE = 5
"""Fewest points in that range: the line and the play have three values (assumed)."""

REACHED = 0.5
"""Share of the largest load pressure that the other side must reach as well (assumed)."""


def fit_pressure(curve: Curve) -> CurveFit:
    """The figures of a pressure gain curve.

    Raises:
        EhaError: the load pressure is zero, is of one sign, or has too few points about null.
    """
    require_points(curve)
    remarks = list(curve.remarks)
    largest, full = float(np.max(np.abs(curve.command))), float(np.max(np.abs(curve.response)))
    if full == 0.0:
        raise EhaError(f"{curve.source}: the load pressure is zero at every point; check that the ports were blocked")
    if min(curve.response.max(), -curve.response.min()) < REACHED * full:
        raise EhaError(
            f"{curve.source}: the load pressure goes from {curve.response.min() / 1e5:.4g} to"
            f" {curve.response.max() / 1e5:.4g} bar; measure both signs, as pressure A minus pressure B"
        )
    inside = np.abs(curve.response) <= RANGE * full
    if np.count_nonzero(inside) < FEWEST_INSIDE:
        raise EhaError(
            f"{curve.source}: {np.count_nonzero(inside)} points lie within {100.0 * RANGE:.0f} % of the largest load"
            f" pressure, {FEWEST_INSIDE} are needed; measure about null in smaller steps"
        )
    command, load = curve.command / largest, curve.response / full
    slope, height = np.polyfit(command[inside], load[inside], 1)
    if slope < 0.0:
        remarks.append("the load pressure falls while the command rises, so its sign was turned; check the polarity")
        curve, load, slope, height = replace(curve, response=-curve.response), -load, -slope, -height
    whole = travel_of(command)
    part = Travel(whole.direction[inside], whole.turned[inside])
    ways = part.is_both_ways

    def law(values: Array) -> Array:
        spool = behind_play(command[inside], part, values[2] if ways else 0.0)
        load_pressure: Array = values[0] * (spool - values[1])
        return load_pressure

    fitted = regress(law, load[inside], [slope, -height / slope, *([0.0] if ways else [])])
    gain, reach = fitted.of(lambda values: float(values[0]))
    null, null_reach = fitted.of(lambda values: float(values[1]))
    values = [
        Value("null_shift", null * largest, null_reach * largest, curve.unit),
        Value("pressure_gain", gain * full / largest, reach * full / largest, f"Pa/{curve.unit}"),
        Value("largest_load_pressure", full, None, "Pa"),
    ]
    if ways:
        width, width_reach = fitted.of(lambda values: 2.0 * float(values[2]))
        values.insert(1, Value("hysteresis", width * largest, width_reach * largest, curve.unit))
    else:
        remarks.append("hysteresis cannot be found: null was passed in one direction of travel only")
    ends = np.array([-RANGE, RANGE])
    half = float(fitted.values[2]) if ways else 0.0
    shifts = {"slope, rising": half, "slope, falling": -half} if ways else {"slope about null": 0.0}
    lines = tuple((label, (null + ends / gain + shift) * largest, ends * full) for label, shift in shifts.items())
    return CurveFit(curve, {row.name: row for row in values}, lines, tuple(remarks))
