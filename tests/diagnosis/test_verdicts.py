"""Whole diagnoses: what is planted is named, what is not there is not named, and the words and files say so."""

import json
from pathlib import Path

import numpy as np
import pytest
from made import LAWS, recorded

from eha_core.cli import main
from eha_core.diagnosis import diagnose
from eha_core.identification.observation import observe, with_sufficient_stroke
from eha_core.nominal import NominalModel
from eha_core.parameters import load_parameters, nominal_values
from eha_core.recording import Channel, Recording
from eha_exam.cases import draw_case
from eha_exam.measuring import measure, simulate_case


def diagnosed(parameters, **how):
    return diagnose(recorded(parameters, **how), nominal_values())


def test_nothing_is_missing_where_nothing_is():
    result = diagnosed({})
    assert result.verdict == "consistent"
    assert not result.effects
    assert not result.location


def test_other_parameters_are_no_missing_physics():
    result = diagnosed({"moving_mass": 12.0, "bulk_modulus": 1.1e9, "damping_coefficient": 1500.0})
    assert result.verdict == "parameters"
    assert not result.effects
    changed = {one.name: one for one in result.parameters if one.changed}
    assert changed["moving_mass"].fitted == pytest.approx(12.0, rel=0.03)
    assert changed["damping_coefficient"].fitted == pytest.approx(1500.0, rel=0.02)


def test_friction_behind_wrong_parameters_is_named_located_and_measured():
    result = diagnosed({"coulomb_friction.force": 180.0, "moving_mass": 11.0, "damping_coefficient": 1700.0})
    assert [effect.id for effect in result.effects] == ["coulomb_friction"]
    force = result.effects[0].parameters["force"]
    assert abs(force.value - 180.0) < max(4.0 * force.std, 1.0)
    assert result.location[0].site == "force"
    assert "only" not in result.effects[0].statement  # it acts always, and is given no span
    assert "effects_from" not in result.fitted_values
    for fit in result.held_out.values():
        assert fit.rmse_after < 1.1 * fit.noise
        assert fit.rmse_calibrated > 1.5 * fit.rmse_after


def test_without_pressures_an_overlap_is_named_or_left_open_beside_the_friction_that_imitates_it():
    """Friction F holds a piston until the pressures differ by 2 F / A, and leakage takes up the flow of a small
    opening meanwhile: a dead zone like the overlap's, but for a supply pressure that hardly anybody would believe."""
    result = diagnosed({"valve_deadband.half_width": 2e-4}, channels=("voltage_command", "position"))
    assert result.effects[0].id == "valve_deadband"
    assert result.effects[0].parameters["half_width"].value == pytest.approx(2e-4, rel=0.01)
    kinds = {LAWS[name].kind for rival in result.alternatives for name in rival.effects}
    assert kinds <= {"dry friction"}


def test_overlap_of_worn_lands_is_named_with_their_rounding():
    result = diagnosed({"valve_deadband.half_width": 2e-4, "valve_deadband.rounding": 6e-5})
    assert result.verdict == "missing_physics"
    assert [effect.id for effect in result.effects] == ["valve_deadband"]
    found = result.effects[0].parameters
    assert found["half_width"].value == pytest.approx(2e-4, rel=0.01)
    assert found["rounding"].value == pytest.approx(6e-5, rel=0.1)


def test_a_delay_is_not_taken_for_a_slow_valve():
    result = diagnosed({"command_delay.delay": 6e-3, "moving_mass": 10.0})
    assert [effect.id for effect in result.effects] == ["command_delay"]
    assert result.effects[0].parameters["delay"].value == pytest.approx(6e-3, rel=0.03)


def test_a_coefficient_that_is_small_in_si_units_is_not_nothing():
    result = diagnosed({"external_leakage.coefficient_a": 2e-12, "external_leakage.coefficient_b": 1e-12})
    assert [effect.id for effect in result.effects] == ["external_leakage"]


def test_a_leakage_turned_on_purpose_is_no_mismatch(capsys):
    assert main(["diagnose", "bags/paper_leakage_levels.mcap", "--json", "-"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["verdict"] == "consistent"
    after = document["fit"]["held_out"]["position"]["rmse_after"]
    assert after < 1e-6  # 1,600 um is what the leakage makes


def test_a_force_that_no_name_fits_is_located_and_not_named():
    case = draw_case("outside", 13, 101)
    assert case.effect_ids == ("periodic_force",)
    units = {"voltage_command": "V", "position": "m", "pressure_a": "Pa", "pressure_b": "Pa"}
    arrays = measure(case, simulate_case(case))
    channels = {name: Channel(name, *arrays[name], unit, name, "made") for name, unit in units.items()}
    recording = Recording(Path("made.mcap"), channels, 0, case.duration, {}, (), None, ())
    nominal = {**nominal_values(), **case.nominal}
    result = diagnose(recording, nominal)
    assert result.verdict == "unknown_physics"
    assert not result.effects
    assert result.location[0].site == "force"


def test_a_piston_beyond_the_nominal_stroke_is_said_to_be_there():
    nominal = {**nominal_values(), "actuator_displacement": 0.005}
    observation, reached = with_sufficient_stroke(observe(recorded({})), NominalModel(nominal))
    farthest = np.max(np.abs(observation.channel("position").values))
    assert reached.values["actuator_displacement"] == pytest.approx(1.05 * farthest)
    assert any("beyond the nominal actuator_displacement" in remark for remark in observation.remarks)


def test_two_effects_at_once_are_both_named(tmp_path, capsys):
    recording = "bags/rig_deadband_and_friction.mcap"
    assert main(["diagnose", recording, "--out", str(tmp_path)]) == 0
    assert "seals rub" in capsys.readouterr().out
    document = json.loads((tmp_path / "diagnosis.json").read_text())
    assert {effect["id"] for effect in document["effects"]} == {"coulomb_friction", "valve_deadband"}
    fitted = load_parameters(tmp_path / "fitted.yaml")
    assert fitted["coulomb_friction.force"] == pytest.approx(250.0, rel=0.02)
    assert fitted["valve_deadband.half_width"] == pytest.approx(2e-4, rel=0.02)
    assert (tmp_path / "report.html").stat().st_size > 100_000
    assert (tmp_path / "comparison.mcap").exists()


def test_a_second_effect_is_named_that_explains_hardly_any_of_what_the_first_does():
    """A slower or faster valve compensates for most of such a delay: the recording tells it to 0.8 ms, as its standard
    deviation says."""
    result = diagnosed({"constant_load.force": 900.0, "command_delay.delay": 8e-3, "moving_mass": 10.0}, duration=6.0)
    found = {effect.id: effect.parameters for effect in result.effects}
    assert set(found) == {"command_delay", "constant_load"}
    delay = found["command_delay"]["delay"]
    assert delay.value == pytest.approx(8e-3, abs=2.0 * delay.std) and delay.std < 1e-3
    assert found["constant_load"]["force"].value == pytest.approx(900.0, rel=0.01)


def test_a_damaged_recording_is_diagnosed_as_far_as_it_goes(tmp_path, capsys):
    assert main(["diagnose", "bags/rig_cut_short.mcap", "--json", "-"]) == 3
    document = json.loads(capsys.readouterr().out)
    assert document["effects"][0]["id"] == "coulomb_friction"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("time,u,x\n" + "".join(f"{k / 100},0.01,{k * 1e-5}\n" for k in range(50)), "too short"),
        ("time,u,x\n" + "".join(f"{k / 100},0.0,{(k % 7) * 1e-3}\n" for k in range(500)), "constant"),
        ("time,u,x\n" + "".join(f"{k / 100},{(k % 9) * 1e-3},0.01\n" for k in range(500)), "does not move"),
    ],
)
def test_a_recording_that_shows_nothing_is_refused_in_one_line(tmp_path, capsys, text, expected):
    recording, topics = tmp_path / "rig.csv", tmp_path / "topics.yaml"
    recording.write_text(text)
    topics.write_text("channels:\n  voltage_command: {column: u}\n  position: {column: x}\n")
    assert main(["diagnose", str(recording), "--topics", str(topics)]) == 2
    assumed, error = capsys.readouterr().err.splitlines()
    assert "the catalogue's cylinder is assumed" in assumed  # a table tells nothing of its rig
    assert "`eha init-rig` makes the file of a rig" in assumed
    assert expected in error


def test_a_missing_recording_is_one_line(capsys):
    assert main(["diagnose", "nowhere.mcap"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
