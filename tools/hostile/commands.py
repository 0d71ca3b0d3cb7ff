"""Commands and parameters that nobody should send: the state stays finite and inside the stroke."""

from __future__ import annotations

import random

import numpy as np

from eha_core.errors import ParameterError
from eha_core.parameters import catalogue, nominal_values
from eha_core.plant import COLUMNS, Plant
from eha_core.realtime import CommandInput
from tools.hostile.extent import Extent
from tools.hostile.row import Row

VOLTS = (0.0, -0.0, 1e-300, 5e-324, 1.0, -1.0, 10.0, 1e3, -1e9, 1e308, float("inf"), -float("inf"), float("nan"))
STEPS = 20
"""Plant steps, a period at 500 Hz, after each event."""
BEYOND = 1e-9
"""m past the stroke's end that rounding may leave."""


def try_commands(extent: Extent, seed: int) -> list[Row]:
    """Send commands and set parameters, legal and not."""
    chance = random.Random(seed)
    row = Row("command and parameter events on the simulated plant", seed)
    rows = catalogue()
    names = list(rows)
    plant, command = Plant(nominal_values(), 1e-4, 0.0), CommandInput(10.0, 0.5)
    course = extent.begin()
    while not course.over(row.times):
        if chance.random() < 0.002:  # a new rig, or one that an earlier value has stiffened would be tried for ever
            plant = Plant(nominal_values(), 1e-4, 0.0)
        if chance.random() < 0.7:
            refused = command.refused
            command.offer(chance.choice((chance.choice(VOLTS), chance.uniform(-12.0, 12.0), chance.gauss(0.0, 0.05))))
            outcome = "commands refused" if command.refused > refused else "commands taken"
        else:
            name = chance.choice(names)
            low, high = rows[name].lower, rows[name].upper
            value = chance.choice((low, high, rows[name].nominal, chance.uniform(low, high), chance.choice(VOLTS)))
            try:
                plant.set_parameters({name: value})
                outcome = "parameters set"
            except ParameterError:
                outcome = "parameters refused"
        plant.advance(command.voltage, STEPS)
        command.elapse(STEPS * 1e-4)
        fault = _fault(plant)
        if fault:
            row.fail(f"event {row.times}: {fault}")
            plant = Plant(nominal_values(), 1e-4, 0.0)
        else:
            row.count(outcome)
    return [row]


def _fault(plant: Plant) -> str | None:
    state = plant.state
    values = {name: getattr(state, name) for name in COLUMNS}
    infinite = [name for name, value in values.items() if not np.isfinite(value)]
    if infinite:
        return f"{', '.join(infinite)} not finite"
    stroke = plant.parameters["actuator_displacement"]
    return f"position {state.position} beyond {stroke}" if abs(state.position) > stroke + BEYOND else None
