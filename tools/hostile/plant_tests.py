"""The tests of the exam's cases on the simulated plant: ten times as fast as on the exam's independent truth."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.parameters import catalogue, nominal_values
from eha_core.plant import Plant
from eha_core.recording.recording import FloatArray
from eha_exam.case import POSITION_NOISE, Case
from eha_exam.excitation import draw_reference, feedforward
from eha_exam.measuring import GENTLER, LOWEST_PRESSURE, STROKE_USED
from eha_exam.plants import Rig
from eha_exam.truth import PositionController

STEP = 1e-4
"""s, of the plant."""

Columns = dict[str, FloatArray]


def is_of_the_catalogue(case: Case) -> bool:
    """Whether the plant has what is concealed in a case, and all of it the whole time."""
    return not case.windows and all(name in catalogue() for name in _effects(case)) and _is_numeric(case)


def run_on_plant(case: Case) -> Columns:
    """The columns of a case's test; as the exam does, a test that runs to an end or draws a vacuum is made gentler."""
    columns = _run(case, case.loop, 1.0)
    for loop, share in GENTLER:
        lowest = min(np.min(columns["pressure_a"]), np.min(columns["pressure_b"]))
        inside = np.max(np.abs(columns["position"])) < STROKE_USED * case.plant["actuator_displacement"]
        if inside and lowest > LOWEST_PRESSURE:
            break
        columns = _run(case, max(loop, case.loop), share)
    return columns


def _effects(case: Case) -> Mapping[str, float | str]:
    return {f"{name}.{key}": value for name, values in case.effects for key, value in values.items()}


def _is_numeric(case: Case) -> bool:
    return not any(isinstance(value, str) for value in _effects(case).values())


def _run(case: Case, loop: float, share: float) -> Columns:
    chance = np.random.default_rng([case.seed, 1])
    rig = Rig(case.family, case.plant)
    time = np.arange(round(case.duration * case.rate) + 1) / case.rate
    reference = draw_reference(case.shape, rig, time, case.amplitude, share * case.speed, chance)
    noise = case.noise * POSITION_NOISE * chance.standard_normal(len(time))
    per_speed = case.plant["coil_resistance"] / rig.speed_per_ampere(1.0)
    controller = PositionController(
        reference, loop * per_speed, case.loop_integral * per_speed,
        case.plant["saturation_current"] * case.plant["coil_resistance"],
        None if case.tier == "tracking" else feedforward(rig, reference, case.rate), noise,
    )  # fmt: skip
    known = {name: value for name, value in {**case.plant, **_effects(case)}.items() if name in catalogue()}
    plant = Plant({**nominal_values(), **{name: float(value) for name, value in known.items()}}, STEP, 0.0)
    steps = round(1.0 / (case.rate * STEP))
    rows, integral = [], 0.0
    for sample in range(len(time)):
        state = plant.state
        voltage, error = controller.command(sample, state.measured_position, integral)
        integral += error / case.rate
        rows.append((voltage, state.position, state.velocity, state.pressure_a, state.pressure_b,
                     state.measured_position, state.measured_pressure_a, state.measured_pressure_b))  # fmt: skip
        plant.advance(voltage, steps)
    names = ("voltage", "position", "velocity", "pressure_a", "pressure_b",
             "measured_position", "measured_pressure_a", "measured_pressure_b")  # fmt: skip
    return {"time": time, "position_noise": noise, **dict(zip(names, np.array(rows).T, strict=True))}
