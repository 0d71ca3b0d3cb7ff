"""Parameters that change while a recording runs: leakage or damping over time."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.result import NamedEffect
from eha_core.effects import effect_title
from eha_core.identification.numbers import Array
from eha_core.report.laws.law import CURVE, Axis, Law, band
from eha_core.report.laws.models import Models, contribution, in_order, values_of
from eha_core.report.wording import capital

NAMES = ("internal_leakage", "damping_coefficient")
UPS = (Axis("Leakage coefficient", "m^3/(s Pa)"), Axis("Damping coefficient", "N s/m"))


def law(models: Models, effect: NamedEffect) -> Law | None:
    """The coefficient that changes most, over time."""
    begin, end = models.diagnosis.drawn
    x: Array = np.linspace(0.0, end - begin, CURVE, dtype=np.float64)
    values = values_of(effect)
    changes = [
        np.ptp(coefficient) / max(float(np.max(coefficient)), 1e-300)
        for coefficient in _over_time(models, effect, values, x)
    ]
    place = int(np.argmax(changes))

    def evaluate(values: Mapping[str, float]) -> Array:
        return _over_time(models, effect, values, x)[place]

    y, low, high = band(effect, evaluate)
    title = capital(effect_title(effect.id))
    return Law(title, Axis("time", "s"), UPS[place], x, y, low, high, 0.0 * x + models.nominal[NAMES[place]])


def _over_time(models: Models, effect: NamedEffect, values: Mapping[str, float], time: Array) -> tuple[Array, Array]:
    call, parameters, p = contribution(effect)[0], in_order(effect, values), models.fitted
    rows = [call(p[NAMES[0]], p[NAMES[1]], instant, *parameters) for instant in time.tolist()]
    found = np.array(rows, dtype=np.float64).T
    return found[0], found[1]
