"""A law as it is drawn, and its band from the uncertainty of its parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module

import numpy as np

from eha_core.diagnosis.result import NamedEffect
from eha_core.identification.numbers import Array
from eha_core.report.laws.models import values_of
from eha_core.report.stage import SURE

CURVE = 241
"""Points of a curve."""

ON_BOUND = 0.01
"""Standard deviations from a bound within which a parameter counts as being on it."""

SHOWN = (0.002, 0.998)
"""Quantiles of the visited states between which a law is drawn."""

NOTHING: Array = np.empty(0)

Evaluate = Callable[[Mapping[str, float]], Array]


@dataclass(frozen=True)
class Axis:
    """A quantity in an engineer's words, and its SI unit."""

    title: str
    unit: str


@dataclass(frozen=True)
class Law:
    """A law y(x) in SI units.

    Attributes:
        title: what it is, in an engineer's words.
        across, up: the quantities x and y.
        x, y, low, high: the fitted curve and its 95 % band; the band is the curve where its width is not known.
        nominal: the nominal model's curve over `x`; empty where it has none.
        points_x, points_y: points computed from the measured channels; empty where no equation contains the law.
    """

    title: str
    across: Axis
    up: Axis
    x: Array
    y: Array
    low: Array
    high: Array
    nominal: Array = field(default_factory=lambda: NOTHING)
    points_x: Array = field(default_factory=lambda: NOTHING)
    points_y: Array = field(default_factory=lambda: NOTHING)


def span_of(values: Array, through_zero: bool = True) -> Array:
    """The x values of a curve over the visited range, with one on either side of zero, where laws may jump."""
    low, high = (float(quantile) for quantile in np.quantile(values, SHOWN))
    places: Array = np.linspace(low, high, CURVE, dtype=np.float64)
    if not through_zero or not low < 0.0 < high:
        return places
    beside = 1e-6 * (high - low)
    return np.sort(np.append(places[np.abs(places) > beside], (-beside, beside)))


def band(effect: NamedEffect, evaluate: Evaluate, more: Array | float = 0.0) -> tuple[Array, Array, Array]:
    """A curve and its 95 % band, from the standard deviation of each of the effect's parameters.

    The parameters' contributions are added as independent ones; `more` is a half width from other parameters. A
    parameter at a bound counts as known, because its standard deviation assumes that it can move to both sides.
    """
    declared = import_module(f"eha_core.effects.{effect.id}").EFFECT.parameters
    bounds = {row.name: (row.lower, row.upper) for row in declared}
    values = values_of(effect)
    curve = evaluate(values)
    square = np.zeros_like(curve) + np.asarray(more) ** 2
    for name, fitted in effect.parameters.items():
        inside = min(abs(fitted.value - bound) for bound in bounds[name])
        if not (np.isfinite(fitted.std) and fitted.std > 0.0) or inside < ON_BOUND * fitted.std:
            continue
        ends = np.clip(fitted.value + SURE * fitted.std * np.array([-1.0, 1.0]), *bounds[name]).tolist()
        moved = [evaluate({**values, name: end}) - curve for end in ends]
        square = square + np.nanmax(np.abs(moved), axis=0) ** 2
    reach = np.sqrt(square)
    return curve, curve - reach, curve + reach
