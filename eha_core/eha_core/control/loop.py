"""A controller and the plant in one loop, without nodes: as a lockstep of the nodes runs it, far faster."""

from __future__ import annotations

import numpy as np

from eha_core.control.interface import Controller, Measurement, Target
from eha_core.control.scoring import Score, score
from eha_core.plant import Plant
from eha_core.signals import Signal


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
