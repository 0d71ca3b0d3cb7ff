"""The rows of a table of smallest sizes: effects with their confusions, nominal parameters, and leaks as flows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import NormalDist

import numpy as np

from eha_core.diagnosis.criteria import CERTAINTY, NOTICEABLE, RELEVANT
from eha_core.diagnosis.detection.confusion import confusions
from eha_core.diagnosis.detection.responses import COMPENSATED, FittedModel, responses
from eha_core.diagnosis.detection.sizes import Trial
from eha_core.diagnosis.result import Detectable, Noticeable
from eha_core.effects import effects
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.observation import WITH_OIL
from eha_core.parameter import Parameter
from eha_core.parameters import catalogue
from eha_core.plant import COLUMNS

ONE_SIDED = NormalDist().inv_cdf(CERTAINTY)
"""Standard deviations below the mean that a normal variable exceeds with CERTAINTY."""

LEAKS = ("internal_leakage_flow", "external_leakage_flow_a", "external_leakage_flow_b")
"""The columns of the plant's rows that are leaks."""


def middle_shapes(tried: Sequence[Trial], factors: Sequence[float]) -> tuple[list[Trial], list[float]]:
    """For each size of each effect, the trial that is stated, and its factor: of the two signs the one with the larger
    factor, and of the search's shapes the one with the middle factor (the lower of two). Trials whose response does not
    depend on the size are ignored."""
    groups: dict[tuple[str, ...], dict[tuple[tuple[str, float], ...], int]] = {}
    for place, trial in enumerate(tried):
        if factors[place] == 0.0:
            continue
        shapes = groups.setdefault(trial.column.sizes, {})
        shape = tuple(sorted(trial.shape.items()))
        if shape not in shapes or factors[place] > factors[shapes[shape]]:
            shapes[shape] = place
    middles = [sorted(shapes.values(), key=lambda place: factors[place])[(len(shapes) - 1) // 2]
               for shapes in groups.values()]  # fmt: skip
    return [tried[place] for place in middles], [factors[place] for place in middles]


def effect_rows(at: FittedModel, tried: Sequence[Trial], factors: Sequence[float]) -> tuple[Detectable, ...]:
    """A row for each trial, whose size is found at its factor; inf: at no size."""
    # an undetectable effect is shown at the search's initial size: at the largest, its own limits would hold the rest
    pairs = zip(tried, factors, strict=True)
    sized = [factor if np.isfinite(factor) else min(1.0, trial.most) for trial, factor in pairs]
    columns = [trial.at(factor) for trial, factor in zip(tried, sized, strict=True)]
    seen = responses(at, columns)
    confused = confusions(columns, seen)
    flows = leak_flows(at, [column.beside(at.fit.values).values for column in columns])
    rows = []
    for k, (trial, factor) in enumerate(zip(tried, factors, strict=True)):
        name, row = _size_of(trial)
        found = bool(np.isfinite(factor))
        share = seen.share(k)
        rows.append(Detectable(
            trial.column.effect.id, row.name, row.unit,
            abs(columns[k].values[name] - row.nominal) if found else None, share,
            seen.compensating(k) if share < COMPENSATED else (),
            {full.partition(".")[2]: value for full, value in trial.shape.items()}, abs(row.typical - row.nominal),
            flows[k] if found else None, confused[k] if found else (),
        ))  # fmt: skip
    return tuple(rows)


def _size_of(trial: Trial) -> tuple[str, Parameter]:
    """The parameter that represents all that grow with the size."""
    name = trial.column.sizes[0]
    return name, next(row for row in trial.column.effect.parameters if name == f"{trial.column.effect.id}.{row.name}")


def leak_flows(at: FittedModel, changes: Sequence[Mapping[str, float]], begin: float = 0.0) -> list[float | None]:
    """The root mean square [m^3/s], from `begin` [s] on, of the largest change of LEAKS for each of these changes of
    values; None of those that are not a leak's."""
    shooting = at.pool.problem.shooting
    leaking = [k for k, values in enumerate(changes) if any(_is_leak(name) for name in values)]
    found: list[float | None] = [None] * len(changes)
    if shooting.drive not in WITH_OIL:
        return found
    sets = [at.fit.values, *({**at.fit.values, **changes[k]} for k in leaking)]
    rows = [shooting.simulate(values, at.fit.states, full=True)[0] for values in sets]
    first = round(begin / (shooting.every * shooting.step_size))
    flows = np.stack([each[first:, [COLUMNS.index(name) for name in LEAKS]] for each in rows])
    added = np.sqrt(np.mean(np.square(flows[1:] - flows[0]), axis=1)).max(axis=1)
    for k, flow in zip(leaking, added.tolist(), strict=True):
        found[k] = flow or None
    return found


def _is_leak(name: str) -> bool:
    """Whether a value belongs to a leak past the piston or out of a chamber; LEAKS has none past the valve's lands."""
    row = catalogue().get(name)
    past_the_lands = any(one.id == name.partition(".")[0] and one.site == "orifice" for one in effects())
    return row is not None and row.unit.startswith("m^3/(s Pa") and not past_the_lands


def parameter_rows(at: FittedModel) -> tuple[Noticeable, ...]:
    """The smallest reported change of each nominal parameter, by the rule of `calibrate.has_changed`."""
    deviations = responses(at, ()).deviations()
    rows = at.observations[0].composition.place_rows
    noticed = {one.name: _noticed(one, deviations[one.name], at) for one in at.pool.plant}
    flows = leak_flows(at, [{name: at.fit.values[name] + change} for name, change in noticed.items()])
    return tuple(
        Noticeable(name, rows[name].unit, one.reference, change, flow)
        for one, (name, change), flow in zip(at.pool.plant, noticed.items(), flows, strict=True)
    )


def _noticed(parameter: FreeParameter, deviation: float, at: FittedModel) -> float:
    value = at.fit.values[parameter.name]
    spread = deviation * at.variance**0.5 * parameter.slope(value)
    relevant = RELEVANT * (abs(value) if parameter.logarithmic else max(abs(value), parameter.scale))
    return float(max(NOTICEABLE * spread, relevant) + ONE_SIDED * spread)
