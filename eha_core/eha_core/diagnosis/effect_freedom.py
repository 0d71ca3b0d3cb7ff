"""The parameters of effects that a fit may move, and the instants between which they act."""

from __future__ import annotations

from collections.abc import Mapping

from eha_core.effects import Effect
from eha_core.identification.freedom import Free

EFFECT_TRUST = 30.0
"""An effect's parameter may move by this many times its starting size, or by e^3 where it moves by factors."""


SHORTEST_INSTANT = 0.01
"""s; over this much an instant is moved to see what that changes."""


def effect_freedom(effect: Effect, start: Mapping[str, float]) -> tuple[Free, ...]:
    """An effect's parameters, free about `start` (full names)."""
    free = []
    for name, row in zip(effect.parameter_names(), effect.parameters, strict=True):
        value = start[name]
        if row.logarithmic and value > 0.0:
            free.append(Free(name, value, True, 0.0, 3.0, row.lower, row.upper))
        else:
            scale = abs(value - row.nominal) or abs(row.typical) or 1.0
            resolution = SHORTEST_INSTANT / scale if row.relative_to == "time" else 0.0
            free.append(Free(name, value, False, scale, EFFECT_TRUST, row.lower, row.upper, resolution))
    return tuple(free)


SPAN_SCALE = 0.3
"""s; the coordinate's unit of an instant from which, or until which, an effect acts."""


def span_freedom(span: Mapping[str, float], bounds: Mapping[str, tuple[float, float]]) -> tuple[Free, ...]:
    """The instants between which the effects act, free about where they are taken to be, within bounds [s]."""
    resolution = SHORTEST_INSTANT / SPAN_SCALE
    return tuple(
        Free(name, at, False, SPAN_SCALE, EFFECT_TRUST, *bounds[name], resolution) for name, at in span.items()
    )
