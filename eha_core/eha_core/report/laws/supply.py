"""Laws of the lines: the pressure at the valve's supply and return port over the flow."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.result import NamedEffect
from eha_core.effects import effect_title
from eha_core.identification.numbers import Array
from eha_core.report.laws.law import CURVE, Axis, Law, band
from eha_core.report.laws.models import Models, contribution, in_order, values_of
from eha_core.report.wording import capital

SETTLED = 1e4
"""s; a step so long that the slowest supply (a time constant of 100 s) has settled in it."""

FLOW = Axis("flow through the valve", "m^3/s")


def law(models: Models, effect: NamedEffect) -> Law | None:
    """The steady pressure over a steady flow, without points: no equation of the chambers contains it alone."""
    velocity = models.state("velocity")
    if not len(velocity):
        return None
    p = models.fitted
    most = float(p["piston_area"] * np.quantile(np.abs(velocity), 0.998))
    x: Array = np.linspace(0.0, most, CURVE // 8, dtype=np.float64)
    values = values_of(effect)
    place = int(np.argmax([np.ptp(pressure) for pressure in _steady(models, effect, values, x)]))

    def evaluate(values: Mapping[str, float]) -> Array:
        return _steady(models, effect, values, x)[place]

    y, low, high = band(effect, evaluate)
    name = ("supply_pressure", "return_pressure")[place]
    up = Axis(("Supply pressure at the valve", "Return pressure at the valve")[place], "Pa")
    title = capital(effect_title(effect.id))
    return Law(title, FLOW, up, x, y, low, high, 0.0 * x + models.nominal[name])


def _steady(models: Models, effect: NamedEffect, values: Mapping[str, float], flow: Array) -> tuple[Array, Array]:
    call, slots = contribution(effect)
    parameters, p = in_order(effect, values), models.fitted
    rows = []
    for drawn in flow.tolist():
        memory = np.zeros(max(slots, 1))
        rows.append(call(p["supply_pressure"], p["return_pressure"], drawn, drawn, memory, 0, SETTLED, *parameters))
    found = np.array(rows, dtype=np.float64).T
    return found[0], found[1]
