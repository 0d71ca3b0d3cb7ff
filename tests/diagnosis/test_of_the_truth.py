"""Single effects concealed in the exam's truth, on rigs of the exam: named, and measured within their intervals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis import diagnose
from eha_core.diagnosis.result import Diagnosis
from eha_core.parameters import nominal_values
from eha_core.recording import Channel, Recording
from eha_exam.case import Case
from eha_exam.concealed import draw_effect
from eha_exam.drawing import draw_case
from eha_exam.measuring import measure, simulate_case

UNITS = {"voltage_command": "V", "position": "m", "pressure_a": "Pa", "pressure_b": "Pa"}


def diagnosed(effect: str, number: int) -> tuple[Case, Diagnosis]:
    """A rig and test of the exam with this effect in place of its own, and what its recording is diagnosed as."""
    case = draw_case("single", number, 31001)
    case = replace(case, effects=((effect, draw_effect(effect, case.setting, np.random.default_rng([case.seed, 7]))),))
    return case, of_case(case)


def of_case(case: Case) -> Diagnosis:
    """What a case's recording is diagnosed as, from its nominal values."""
    arrays = measure(case, simulate_case(case))
    channels = {name: Channel(name, *arrays[name], unit, name, "made") for name, unit in UNITS.items()}
    recording = Recording(Path("made.mcap"), channels, 0, case.duration, {}, (), None, ())
    return diagnose(recording, {**nominal_values(), **case.nominal})


@pytest.mark.parametrize(("effect", "number"), [("bore_wear_leakage", 3), ("pressure_sensor_lag", 2)])
def test_it_is_named_with_intervals_that_hold_it(effect: str, number: int) -> None:
    case, result = diagnosed(effect, number)
    assert result.verdict == "missing_physics"
    assert [one.id for one in result.effects] == [effect]
    truth = dict(case.effects)[effect]
    for name, found in result.effects[0].parameters.items():
        assert found.std < 0.1 * max(abs(found.value), abs(float(truth[name])))
        assert abs(found.value - float(truth[name])) < 3.0 * found.std, name
    assert max(fit.rmse_after / fit.noise for fit in result.held_out.values()) < 1.1


def test_parameters_do_not_end_in_a_local_minimum_far_from_their_nominal_values() -> None:
    """Oil four times too soft and a leak 26 times too large left 226 chi^2 more than the optimum beside a delay."""
    case = draw_case("single", 0, 2026)
    result = of_case(case)
    assert [one.id for one in result.effects] == ["command_delay"]
    found = {one.name: one for one in result.parameters}
    for name in ("valve_gain", "bulk_modulus", "internal_leakage", "valve_natural_frequency"):
        assert abs(found[name].fitted - case.plant[name]) < 4.0 * found[name].std, name


def test_a_pressure_that_was_stamped_late_is_named_as_a_late_sensor() -> None:
    """A dead time in one channel, of which a lag with the same delay is left at the frequencies of the motion."""
    recording = recorded({"moving_mass": 10.0})
    first = recording.channels["pressure_a"]
    late = {**recording.channels, "pressure_a": replace(first, time=first.time + 6e-3)}
    result = diagnose(replace(recording, channels=late), nominal_values())
    assert [one.id for one in result.effects] == ["pressure_sensor_lag"]
    found = result.effects[0].parameters
    assert found["time_constant_a"].value == pytest.approx(6e-3, rel=0.15)
    assert found["time_constant_b"].value < 1e-3
