"""Sets of effects: found together, without what is not significant, with the residual stated."""

from dataclasses import replace

import numpy as np
import pytest

from eha_core.diagnosis import diagnose
from eha_core.diagnosis.verdict import coherence
from eha_core.parameters import nominal_values
from eha_core.recording import Channel, Recording
from eha_exam.drawing import draw_case
from eha_exam.measuring import measure, simulate_case


def diagnosed(number, seed, names, noise):
    """A rig of the exam with these of its effects alone, and what a short test of it is diagnosed as.

    By the exam's truth, which shares neither equations nor integrator with the plant.
    """
    case = replace(
        draw_case("rig", number, seed),
        duration=8.0, rate=500.0, noise=noise, position_step=0.0, pressure_step=0.0, jitter=0.0, dropout=0.0,
    )  # fmt: skip
    case = replace(case, effects=tuple(one for one in case.effects if one[0] in names))
    units = {"voltage_command": "V", "position": "m", "pressure_a": "Pa", "pressure_b": "Pa"}
    channels = {
        name: Channel(name, time, values, units[name], name, "made")
        for name, (time, values) in measure(case, simulate_case(case)).items()
    }
    recording = Recording("made.mcap", channels, 0, case.duration, {}, (), None, ())
    return case, diagnose(recording, {**nominal_values(), **case.nominal})


def exactly(result, case):
    """Whether physics is said to be missing, and just what is concealed is named."""
    named = sorted(effect.id for effect in result.effects)
    return result.verdict == "missing_physics" and named == sorted(case.effect_ids)


def test_damping_beside_dry_friction_is_not_taken_for_stribecks_curve():
    """Stribeck's law explains both nearly, with as many parameters: damping then has little left to explain."""
    case, result = diagnosed(20, 11300, ("coulomb_friction", "quadratic_damping", "turbulent_leakage"), 10.0)
    assert exactly(result, case)


def test_three_effects_of_another_plant_are_named_and_nothing_else():
    case, result = diagnosed(3, 9001, ("coulomb_friction", "supply_pressure_droop", "constant_load"), 1.0)
    assert exactly(result, case)
    truth = dict(case.effects)
    load = next(effect for effect in result.effects if effect.id == "constant_load").parameters["force"]
    assert abs(load.value - float(truth["constant_load"]["force"])) < max(4.0 * load.std, 0.01 * abs(load.value))
    assert result.explained.complete
    assert max(result.explained.times_noise.values()) < 1.1
    assert all(result.prediction[name].ahead[0.25] < 1.5 * fit.noise for name, fit in result.held_out.items())


def test_noise_is_not_coherent_and_a_slow_rest_is():
    noise = np.random.default_rng(1).standard_normal(20_000)
    assert coherence(noise) == pytest.approx(1.0, abs=0.1)
    assert coherence(noise + np.sin(np.arange(20_000) / 500.0)) > 2.0
