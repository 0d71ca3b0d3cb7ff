"""A controller and the plant in one loop, without nodes: as a lockstep of the nodes runs it, far faster."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy

import numpy as np

from eha_core.control.interface import Controller, Measurement, Target
from eha_core.control.scoring import Array, Score, score
from eha_core.plant import COLUMNS, PAPER, Composition, Plant
from eha_core.plant.lane_rows import LANES
from eha_core.plant.lockstep import LockStep
from eha_core.plant.simulator import starting_pressures
from eha_core.signals import Signal

_POSITION = COLUMNS.index("position")
_MEASURED = [COLUMNS.index(name) for name in ("measured_position", "measured_velocity", "hydraulic_force")]


def follow(
    controller: Controller, plant: Plant, reference: Signal, seconds: float, period: float, skip: float
) -> Score:
    """Let the controller lead the plant along the reference; score what comes from `skip` [s] on.

    Each measurement is answered by one voltage, which holds for `period` [s], a whole number of the plant's steps.
    """
    steps = round(period / plant.step_size)
    rows = []
    for number in range(round(seconds / period) + 1):
        state, time = plant.state, number * period
        target = Target(float(reference.value(time)), float(reference.derivative(time)))
        measured = Measurement(state.measured_position, state.measured_velocity, state.hydraulic_force)
        voltage = controller.voltage(measured, target)
        error = measured.position - target.position
        rows.append((error, voltage, state.flow_a, state.flow_b, state.supply_pressure))
        plant.advance(voltage, steps)
    error, voltage, flow_a, flow_b, supply_pressure = np.array(rows[round(skip / period) :]).T
    return score(error, voltage, flow_a, flow_b, supply_pressure, period)


def follow_together(
    controller: Controller, sets: Sequence[Mapping[str, float]], reference: Signal, seconds: float, period: float,
    step_size: float = 1e-4, composition: Composition = PAPER,
) -> Array:  # fmt: skip
    """Let copies of the controller lead a plant each along the reference, as `follow` does with one.

    Args:
        controller: made for the rig as it is known; every plant gets a fresh copy.
        sets: every parameter of each plant, by its name in the equations.
        reference: the position to follow [m]; each plant starts on it, at rest.
        seconds: length of the run [s].
        period: time between two commands [s], a whole number of steps.
        step_size: the plants' step [s].
        composition: the plants' parts; a voltage has to drive them.

    Returns:
        The pistons' true positions [m], (sets, commands + 1): where each stands when a command is due. What the
        controller sees is what the sensors say.
    """
    times = np.arange(round(seconds / period) + 1) * period
    targets = [Target(*pair) for pair in np.stack([reference.value(times), reference.derivative(times)], 1).tolist()]
    found = np.empty((len(sets), len(times)))
    for first in range(0, len(sets), LANES):
        block = sets[first : first + LANES]
        found[first : first + LANES] = _follow_block(controller, block, targets, round(period / step_size), step_size,
                                                     composition)  # fmt: skip
    return found


def _follow_block(
    controller: Controller, sets: Sequence[Mapping[str, float]], targets: Sequence[Target], steps: int,
    step_size: float, composition: Composition,
) -> Array:  # fmt: skip
    """The same of as many plants as go in lock-step, under commands of their own."""
    controllers = [deepcopy(controller) for _ in sets]
    for each in controllers:
        each.reset()
    start = targets[0].position
    lanes = LockStep(sets, step_size, own_commands=True)
    lanes.place(np.array([[start, 0.0, *starting_pressures(values, start, composition)] for values in sets]))
    lanes.start_memory()
    row = np.empty((1, len(COLUMNS), lanes.lanes))
    positions = np.full((len(targets), len(sets)), start)
    seen = [Measurement(start, 0.0, 0.0)] * len(sets)
    for tick, target in enumerate(targets):
        voltages = [law.voltage(measured, target) for law, measured in zip(controllers, seen, strict=True)]
        if tick + 1 < len(targets):
            lanes.advance_each(tick * steps, np.array(voltages), steps, row)
            positions[tick + 1] = row[0, _POSITION, : len(sets)]
            seen = [Measurement(*values) for values in row[0, _MEASURED, : len(sets)].T.tolist()]
    return positions.T
