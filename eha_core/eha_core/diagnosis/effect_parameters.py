"""The free parameters of effects, and the ends of the intervals in which they act."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eha_core.diagnosis.criteria import NEXT_TO_NOTHING
from eha_core.effects import Effect
from eha_core.identification.fit import Fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.per_recording import base_name
from eha_core.parameters import catalogue

EFFECT_PRIOR = 30.0
"""Prior standard deviation of an effect's parameter, in units of its initial size; 3 in a logarithmic one's
logarithm."""


KNOT_PRIOR = 3.0
"""Prior standard deviation of a knot, in units of the largest initial knot."""

MOST_ABOVE = 3.0
"""Share by which static friction may exceed kinetic friction. Seals show up to twice as much (assumed); without a
bound, friction that vanishes in motion is confounded with Coulomb friction and damping that grows with the speed."""

SHORTEST_INSTANT = 0.01
"""s; smallest finite difference of an instant."""


def free_effect_parameters(effect: Effect, start: Mapping[str, float]) -> tuple[FreeParameter, ...]:
    """An effect's free parameters, with their priors about `start` (full names)."""
    free = []
    if not effect.named:
        return _free_knots(effect, start)
    for name, row in zip(effect.parameter_names(), effect.parameters, strict=True):
        value = start[name]
        if row.above:
            above = f"{effect.id}.{row.above}"
            free.append(FreeParameter(name, 0.0, False, 1.0, EFFECT_PRIOR, 0.0, MOST_ABOVE, above=above))
            continue
        if row.logarithmic and value > 0.0:
            free.append(FreeParameter(name, value, True, 0.0, 3.0, row.lower, row.upper))
        else:
            scale = abs(value - row.nominal) or abs(row.typical) or 1.0
            resolution = SHORTEST_INSTANT / scale if row.relative_to == "time" else 0.0
            free.append(FreeParameter(name, value, False, scale, EFFECT_PRIOR, row.lower, row.upper, resolution))
    return tuple(free)


def _free_knots(effect: Effect, start: Mapping[str, float]) -> tuple[FreeParameter, ...]:
    """The free knots of a curve, with their priors about `start`, in units of the largest of them."""
    rows = {f"{effect.id}.{row.name}": row for row in effect.parameters if row.switches}
    scale = max(abs(start[name]) for name in rows) or 1.0
    return tuple(
        FreeParameter(name, start[name], False, scale, KNOT_PRIOR, row.lower, row.upper) for name, row in rows.items()
    )


def with_effects(
    free: Sequence[FreeParameter], effects: Sequence[Effect], values: Mapping[str, float]
) -> tuple[FreeParameter, ...]:
    """The free parameters with those of more effects, whose priors are about `values`."""
    extra = [parameter for effect in effects for parameter in free_effect_parameters(effect, values)]
    names = {parameter.name for parameter in extra}
    return (*(parameter for parameter in free if parameter.name not in names), *extra)


SPAN_SCALE = 0.3
"""s; unit of the coordinate of an active interval's begin or end."""


def free_instants(span: Mapping[str, float], bounds: Sequence[tuple[float, float]]) -> tuple[FreeParameter, ...]:
    """The free begin and end of an active interval, with priors about `span` [s], within `bounds` [s]."""
    resolution = SHORTEST_INSTANT / SPAN_SCALE
    return tuple(
        FreeParameter(name, at, False, SPAN_SCALE, EFFECT_PRIOR, *within, resolution)
        for (name, at), within in zip(span.items(), bounds, strict=True)
    )


def parameters_used(result: Fit) -> int:
    """How many parameters of a fit count: an effect's shape parameter near its neutral value does not.

    A dead band with sharp edges is not charged for its rounding.
    """
    return sum(not _is_no_shape(result, parameter.name) for parameter in result.free)


def _is_no_shape(result: Fit, name: str) -> bool:
    if "." not in name:
        return False  # a parameter of the plant; those of a source have no row in the catalogue
    row = catalogue()[base_name(name)]
    may_be_nothing = not row.switches and row.lower == row.nominal
    return may_be_nothing and result.values[name] - row.lower < NEXT_TO_NOTHING * abs(row.typical)
