"""A certificate of a planned test: the smallest size of each effect that is found, and what it is confounded with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from eha_core.detectability.confusion import Confusion, confusions
from eha_core.detectability.linear import COMPENSATED, responses
from eha_core.detectability.planned import NOISE, Linearised, PlannedTest, linearised
from eha_core.detectability.power import POWER
from eha_core.detectability.refit import confirmed
from eha_core.detectability.sizes import Trial, smallest, trials
from eha_core.diagnosis.criteria import NOTICEABLE, RELEVANT
from eha_core.identification.free_parameters import FreeParameter
from eha_core.nominal import NominalModel
from eha_core.parameter import Parameter
from eha_core.parameters import catalogue
from eha_core.plant import simulate_many

ONE_SIDED = 1.645
"""Standard deviations below the mean that a normal variable exceeds with POWER."""


@dataclass(frozen=True)
class Detectable:
    """An effect, or one of its independent sizes, and the smallest value of it that is found.

    Attributes:
        effect: its id. parameter: the size's short name. unit: of the values, SI.
        size: what is found with POWER; None where no size up to the catalogue's bound is.
        with_pressures: the same where both pressures are recorded too; None where they are already, or it is not found.
        share: of the response that nominal parameters cannot compensate. compensated_by: those that take most of it.
        shape: the effect's other values, by short name, at which this holds.
        typical: a size that is usual on a bench actuator.
        flow: of a leak, the flow that this size adds in the test, root mean square [m^3/s]; None of anything else.
        confusions: other effects that explain the response at this size about as well.
    """

    effect: str
    parameter: str
    unit: str
    size: float | None
    with_pressures: float | None
    share: float
    compensated_by: tuple[str, ...]
    shape: Mapping[str, float]
    typical: float
    flow: float | None = None
    confusions: tuple[Confusion, ...] = ()


@dataclass(frozen=True)
class Noticeable:
    """A nominal parameter, and by how much it must differ from its nominal value for the difference to be reported;
    `flow`: of a leakage, the flow [m^3/s, root mean square] that this adds in the test."""

    name: str
    unit: str
    nominal: float
    change: float
    flow: float | None = None


@dataclass(frozen=True)
class Certificate:
    """What a planned test can show.

    Attributes:
        test: the test.
        power: the probability with which what is listed is found.
        samples: how many there are.
        effects: the effects, in the catalogue's order. parameters: the nominal parameters.
        stroke: the largest distance from mid stroke, as a share of the stroke.
        scales: full values that sizes may be compared with, by unit [SI].
        remarks: what to know of the test.
    """

    test: PlannedTest
    power: float
    samples: int
    effects: tuple[Detectable, ...]
    parameters: tuple[Noticeable, ...]
    stroke: float
    scales: Mapping[str, float]
    remarks: tuple[str, ...] = ()


def certify(model: NominalModel, test: PlannedTest) -> Certificate:
    """What a diagnosis would find in a recording of this test of a rig that is as modelled but for one effect.

    Raises ParameterError for an actuator that no voltage drives.
    """
    with threadpool_limits(1):
        at = linearised(model, test)
        tried, factors = middle_shapes(*_measured(at))
        rows = _effects(at, tried, confirmed(at, tried, factors))
        if not set(NOISE) <= set(test.channels):
            rows = _with_pressures(rows, linearised(model, test.recording(tuple(NOISE))))
        values = model.values
        area, drop = values["piston_area"], values["supply_pressure"] - values["return_pressure"]
        scales = {"m": values["actuator_displacement"], "A": values["saturation_current"], "N": area * drop, "Pa": drop}
        stroke = float(np.max(np.abs(at.motion.position))) / values["actuator_displacement"]
        return Certificate(test, POWER, at.fit.count, rows, _parameters(at), stroke, scales, _remarks(at, stroke))


def _measured(at: Linearised) -> tuple[list[Trial], list[float]]:
    tried = trials(at)
    return tried, smallest(at, tried).tolist()


def middle_shapes(tried: Sequence[Trial], factors: Sequence[float]) -> tuple[list[Trial], list[float]]:
    """Of each size of each effect the trial that is certified, and its factor: of the two signs the one that needs
    more, and of the shapes that the search tries the one that needs the middle factor (the lower of two)."""
    groups: dict[tuple[str, ...], dict[tuple[tuple[str, float], ...], int]] = {}
    for place, trial in enumerate(tried):
        shapes = groups.setdefault(trial.column.sizes, {})
        shape = tuple(sorted(trial.shape.items()))
        if shape not in shapes or factors[place] > factors[shapes[shape]]:
            shapes[shape] = place
    middles = [sorted(shapes.values(), key=lambda place: factors[place])[(len(shapes) - 1) // 2]
               for shapes in groups.values()]  # fmt: skip
    return [tried[place] for place in middles], [factors[place] for place in middles]


def _effects(at: Linearised, tried: Sequence[Trial], factors: Sequence[float]) -> tuple[Detectable, ...]:
    # what is not found is shown at the size that the search begins with: at the largest its own limits hold the rest
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
            abs(columns[k].values[name] - row.nominal) if found else None, None, share,
            seen.compensating(k) if share < COMPENSATED else (),
            {full.partition(".")[2]: value for full, value in trial.shape.items()}, abs(row.typical - row.nominal),
            flows[k] if found else None, confused[k] if found else (),
        ))  # fmt: skip
    return tuple(rows)


LEAKS = ("internal_leakage_flow", "external_leakage_flow_a", "external_leakage_flow_b")
"""The columns of the plant's rows that are leaks."""


def leak_flows(at: Linearised, changes: Sequence[Mapping[str, float]]) -> list[float | None]:
    """What the largest of LEAKS is changed by in the test, root mean square [m^3/s], for each of these changes of
    values; None of those that are no leak's."""
    leaking = [k for k, values in enumerate(changes) if any(_is_leak(name) for name in values)]
    composition, shooting = at.observation.composition, at.pool.problem.shooting
    sets = [at.fit.values, *({**at.fit.values, **changes[k]} for k in leaking)]
    flows = simulate_many(
        [composition.named(values) for values in sets], shooting.inputs[0], step_size=shooting.step_size,
        every=shooting.every, columns=LEAKS, composition=composition,
    ).values  # fmt: skip
    added = np.sqrt(np.mean(np.square(flows[1:] - flows[0]), axis=1)).max(axis=1)
    found: list[float | None] = [None] * len(changes)
    for k, flow in zip(leaking, added.tolist(), strict=True):
        found[k] = flow or None
    return found


def _is_leak(name: str) -> bool:
    row = catalogue().get(name)
    return row is not None and row.unit.startswith("m^3/(s Pa")


def _size_of(trial: Trial) -> tuple[str, Parameter]:
    """The size that stands for all that grow with it."""
    name = trial.column.sizes[0]
    return name, next(row for row in trial.column.effect.parameters if name == f"{trial.column.effect.id}.{row.name}")


def _with_pressures(rows: Sequence[Detectable], at: Linearised) -> tuple[Detectable, ...]:
    """The rows with the sizes that are found where pressures are recorded too; and effects that only these show. Of
    these sizes the linearisation is believed."""
    more = {(row.effect, row.parameter): row for row in _effects(at, *middle_shapes(*_measured(at)))}
    known = {(row.effect, row.parameter) for row in rows}
    found = [replace(row, with_pressures=more[row.effect, row.parameter].size) for row in rows]
    added = [replace(row, size=None, flow=None, with_pressures=row.size, confusions=())
             for key, row in more.items() if key not in known]  # fmt: skip
    return (*found, *added)


def _parameters(at: Linearised) -> tuple[Noticeable, ...]:
    """By how much each nominal parameter must differ to be reported as changed: `calibrate.has_changed` is the rule."""
    deviations = responses(at, ()).deviations()
    rows = at.observation.composition.place_rows
    noticed = {one.name: _noticed(one, deviations[one.name], at) for one in at.pool.plant}
    flows = leak_flows(at, [{name: at.fit.values[name] + change} for name, change in noticed.items()])
    return tuple(
        Noticeable(name, rows[name].unit, at.fit.values[name], change, flow)
        for (name, change), flow in zip(noticed.items(), flows, strict=True)
    )


def _noticed(parameter: FreeParameter, deviation: float, at: Linearised) -> float:
    value = at.fit.values[parameter.name]
    spread = deviation * parameter.slope(value)
    relevant = RELEVANT * (abs(value) if parameter.logarithmic else max(abs(value), parameter.scale))
    return max(NOTICEABLE * spread, relevant) + ONE_SIDED * spread


def _remarks(at: Linearised, stroke: float) -> tuple[str, ...]:
    remarks = []
    if stroke > 0.98:
        remarks.append("the piston reaches the end of its stroke: give a smaller or slower command")
    saturation = at.fit.values["saturation_current"] * at.fit.values["coil_resistance"]
    largest = float(np.max(np.abs(at.motion.voltage)))
    if largest > saturation:
        remarks.append(f"the command reaches {largest:.3g} V, and the coil saturates at {saturation:.3g} V")
    return tuple(remarks)
