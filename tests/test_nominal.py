"""A nominal file with unknown values and values that differ by recording: what is read, and what is refused."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from eha_core.api import known_model, nominal_model
from eha_core.errors import ParameterError
from eha_core.nominal import NominalModel, load_nominal, nominal_of
from eha_core.parameters import load_parameters, nominal_values
from eha_core.plant import voltage_driven
from eha_core.recording import read_recording

BAG = Path(__file__).resolve().parent.parent / "bags" / "rig_as_modelled.mcap"

FILE = """\
/**/eha_sim:
  ros__parameters:
    moving_mass: 24.0
    bulk_modulus: unknown
    line_volume: Unknown
    coulomb_friction.force: 120.0
    per_recording: [supply_pressure, external_leakage_effect.coefficient_a]
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "rig.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_an_unknown_value_is_the_catalogue_s_and_is_named(tmp_path: Path) -> None:
    model = load_nominal(write(tmp_path, FILE))
    assert model.unknown == {"bulk_modulus", "line_volume"}
    assert model.per_recording == ("supply_pressure", "external_leakage.coefficient_a")
    assert dict(model.values) == {**nominal_values(), "moving_mass": 24.0, "coulomb_friction.force": 120.0}


def test_what_differs_by_recording_may_stand_at_the_top_and_counts_once(tmp_path: Path) -> None:
    text = "per_recording: [moving_mass, moving_mass]\neha_sim:\n  ros__parameters: {moving_mass: 2}\n"
    assert load_nominal(write(tmp_path, text)).per_recording == ("moving_mass",)


def test_a_file_without_unknowns_is_the_same_plant_as_before(tmp_path: Path) -> None:
    path = write(tmp_path, "eha_sim:\n  ros__parameters: {moving_mass: 2, supply_pressure: 1e7}\n")
    assert load_nominal(path) == NominalModel({**nominal_values(), **load_parameters(path)})


def test_every_way_to_give_a_model_tells_what_is_unknown(tmp_path: Path) -> None:
    recording = read_recording(BAG)
    given = nominal_of({"moving_mass": "unknown"}, ["supply_pressure"])
    assert known_model(given, recording) is given
    assert known_model({"moving_mass": "unknown"}, recording).unknown == {"moving_mass"}
    assert known_model(write(tmp_path, FILE), recording).unknown == {"bulk_modulus", "line_volume"}
    assert known_model(None, recording).unknown == frozenset()
    assert nominal_model(write(tmp_path, FILE), recording)["bulk_modulus"] == nominal_values()["bulk_modulus"]


@pytest.mark.parametrize(
    ("section", "message"),
    [
        ("moving_mas: unknown", "there is no parameter named moving_mas; did you mean moving_mass?"),
        ("moving_mass: unknwon", "moving_mass = 'unknwon' is not a number"),
        ("coulomb_friction.force: unknown", "coulomb_friction.force is unknown, which a diagnosis of effects finds"),
        ("per_recording: [suply_pressure]", "per_recording: there is no parameter named suply_pressure; did you mean"),
        ("per_recording: supply_pressure", "per_recording = 'supply_pressure' is no list of names"),
        ("per_recording: [3]", "per_recording = [3] is no list of names"),
        ("return_pressure: 3e7", "return_pressure = 3e+07 Pa is out of range"),
    ],
)
def test_what_makes_no_model_is_refused_in_one_line(tmp_path: Path, section: str, message: str) -> None:
    path = write(tmp_path, f"eha_sim:\n  ros__parameters:\n    {section}\n")
    with pytest.raises(ParameterError) as caught:
        load_nominal(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_simulation_refuses_unknown_values_and_passes_over_what_differs_by_recording(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="bulk_modulus is unknown, which only a diagnosis takes; .* in Pa"):
        load_parameters(write(tmp_path, FILE))
    known = FILE.replace("bulk_modulus: unknown", "bulk_modulus: 1.0e9").replace("    line_volume: Unknown\n", "")
    assert load_parameters(write(tmp_path, known))["bulk_modulus"] == 1e9


PARTS = "eha_sim:\n  ros__parameters:\n    plant: {{{parts}}}\n{lines}"


def composed(folder: Path, parts: str, *lines: str) -> Path:
    path = folder / "rig.yaml"
    path.write_text(PARTS.format(parts=parts, lines="".join(f"    {line}\n" for line in lines)))
    return path


def test_a_file_s_parts_are_the_model_s(tmp_path: Path) -> None:
    lines = ("piston_area: 1.2e-3", "piston_area_b: 7.8e-4", "moving_mass: unknown", "per_recording: [supply_pressure]")
    model = load_nominal(composed(tmp_path, "cylinder: single_rod", *lines))
    assert str(model.composition) == "servo_valve, single_rod, sprung_mass"
    assert model.values == nominal_values() | {"piston_area": 1.2e-3, "piston_area_b": 7.8e-4}
    assert model.unknown == {"moving_mass"}
    assert model.per_recording == ("supply_pressure",)


def test_names_of_a_vane_are_brought_to_the_equations(tmp_path: Path) -> None:
    lines = ("vane_displacement: 2.0e-5", "moment_of_inertia: unknown", "per_recording: [rotational_damping]")
    model = load_nominal(composed(tmp_path, "cylinder: rotary_vane", *lines))
    assert model.values["piston_area"] == model.values["piston_area_b"] == 2e-5
    assert model.values["moving_mass"] == 0.5
    assert model.unknown == {"moving_mass"}
    assert model.per_recording == ("damping_coefficient",)


@pytest.mark.parametrize(
    ("parts", "line", "said"),
    [
        ("cylinder: rotary_vane", "moving_mass: unknown", "moving_mass does not apply to this plant"),
        ("source: measured_flow", "per_recording: [valve_gain]", "per_recording: valve_gain does not apply"),
        ("source: servovalve", "moving_mass: 9.0", "plant.source = servovalve is unknown; did you mean servo_valve?"),
        ("sauce: servo_valve", "moving_mass: 9.0", "plant.sauce is unknown; did you mean source?"),
    ],
)
def test_parts_and_names_that_do_not_fit_are_refused(tmp_path: Path, parts: str, line: str, said: str) -> None:
    with pytest.raises(ParameterError, match=re.escape(said)):
        load_nominal(composed(tmp_path, parts, line))


@pytest.mark.parametrize("parts", ["source: switched_pump", "cylinder: rotary_vane"])
def test_a_reader_of_voltages_refuses_other_plants_in_one_line(tmp_path: Path, parts: str) -> None:
    with pytest.raises(ParameterError, match=r"rig.yaml: plant\.\w+ = \w+ is not taken here; `eha simulate` takes it"):
        voltage_driven(composed(tmp_path, parts, "bulk_modulus: 1.0e9"))
