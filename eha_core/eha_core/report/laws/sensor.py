"""Laws of a sensor: its error over the true value."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.result import NamedEffect
from eha_core.effects import effect_title
from eha_core.identification.numbers import Array
from eha_core.report.laws.law import Axis, Law, band, span_of
from eha_core.report.laws.models import Models, contribution, in_order, values_of
from eha_core.report.series import spread
from eha_core.report.wording import capital, channel_title

SENSED = ("position", "velocity", "pressure_a", "pressure_b")
UNITS = {"position": "m", "velocity": "m/s", "pressure_a": "Pa", "pressure_b": "Pa"}


def law(models: Models, effect: NamedEffect) -> Law | None:
    """The error of the sensor that the effect changes most; None for an effect with memory, such as a lag or play."""
    if contribution(effect)[1]:
        return None
    pictures = models.diagnosis.pictures
    values = values_of(effect)
    candidates = [name for name in SENSED if name in pictures.after]
    at = {name: pictures.after[name] for name in candidates}
    sizes = {name: float(np.max(np.abs(error(effect, values, name, span_of(at[name]))))) / UNIT[name] for name in at}
    name = max(sizes, key=sizes.__getitem__)
    x = span_of(at[name])

    def evaluate(values: Mapping[str, float]) -> Array:
        return error(effect, values, name, x)

    y, low, high = band(effect, evaluate)
    points_x, left = spread(at[name], pictures.measured[name] - at[name])
    title = capital(effect_title(effect.id))
    across, up = Axis(channel_title(name), UNITS[name]), Axis("Shown minus true", UNITS[name])
    return Law(title, across, up, x, y, low, high, 0.0 * x, points_x, np.interp(points_x, x, y) + left)


UNIT = {"position": 1e-5, "velocity": 1e-3, "pressure_a": 1e4, "pressure_b": 1e4}
"""Usual noise of each sensor, in which its error is compared [its unit]."""


def error(effect: NamedEffect, values: Mapping[str, float], name: str, true: Array) -> Array:
    """The error of a sensor at these true values."""
    call, parameters = contribution(effect)[0], in_order(effect, values)
    place = SENSED.index(name)
    shown = []
    for value in true.tolist():
        state = [0.0, 0.0, 0.0, 0.0]
        state[place] = value
        shown.append(call(*state, np.zeros(1), 0, 1e-4, *parameters)[place])
    return np.asarray(np.array(shown, dtype=np.float64) - true)
