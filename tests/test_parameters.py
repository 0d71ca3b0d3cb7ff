"""Rows, whole sets and parameter files: what is taken, what is refused, and in which words."""

from __future__ import annotations

from pathlib import Path

import pytest

from eha_core.effects import effects
from eha_core.errors import ParameterError
from eha_core.node_parameters import from_node, node_name, to_node
from eha_core.parameters import NOMINAL, catalogue, changed, dump_parameters, load_parameters, nominal_values

TABLE_1 = {
    "coil_resistance": 100.0, "coil_inductance": 0.59, "saturation_current": 0.02, "valve_damping_ratio": 0.48,
    "valve_natural_frequency": 543.0, "valve_gain": 2.38e-5, "bulk_modulus": 1.4e9, "supply_pressure": 2.1e7,
    "return_pressure": 0.0, "spring_stiffness": 10.0, "actuator_displacement": 0.1, "piston_area": 645e-6,
    "moving_mass": 9.0, "damping_coefficient": 2000.0, "internal_leakage": 1e-12, "external_leakage": 0.0,
}  # fmt: skip


def write(folder: Path, text: str) -> Path:
    path = folder / "plant.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_nominal_values_are_those_of_table_1() -> None:
    values = nominal_values()
    assert {name: values[name] for name in TABLE_1} == TABLE_1


def test_the_catalogue_holds_the_nominal_rows_then_each_effects_then_when_they_act() -> None:
    of_effects = [name for effect in effects() for name in effect.parameter_names()]
    when = [name for effect in effects() for name in effect.acting_names()]
    assert list(catalogue()) == [row.name for row in NOMINAL] + of_effects + ["effects_from", "effects_until", *when]
    assert "coulomb_friction.acts_from" in when


@pytest.mark.parametrize("name", list(catalogue()))
def test_each_row_is_whole_and_takes_its_bounds_and_nothing_past_them(name: str) -> None:
    row = catalogue()[name]
    assert row.symbol
    assert row.unit
    assert row.meaning
    assert row.source
    assert row.lower <= row.nominal <= row.upper
    assert row.check(row.lower) == row.lower
    assert row.check(row.upper) == row.upper
    beyond = row.upper + abs(row.upper) + 1.0
    with pytest.raises(ParameterError, match=rf"^{row.name} = .* is out of range; give .* to .*{row.unit[:1]}"):
        row.check(beyond)


@pytest.mark.parametrize("value", [True, "12", None, [1.0], 1j])
def test_what_is_no_number_is_refused(value: object) -> None:
    with pytest.raises(ParameterError, match="moving_mass = .* is not a number; give one in kg"):
        changed(nominal_values(), {"moving_mass": value})


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_what_is_not_finite_is_refused(value: float) -> None:
    with pytest.raises(ParameterError, match="moving_mass = .* is not finite; give 0.01 to 100000 kg"):
        changed(nominal_values(), {"moving_mass": value})


def test_an_unknown_name_is_answered_with_the_nearest() -> None:
    with pytest.raises(ParameterError, match="no parameter named internal_leak; did you mean internal_leakage"):
        changed(nominal_values(), {"internal_leak": 1e-12})
    with pytest.raises(ParameterError, match="`eha effects --parameters` lists the names"):
        changed(nominal_values(), {"xyzzy": 1.0})


def test_pressures_are_checked_together() -> None:
    with pytest.raises(ParameterError, match="supply_pressure = 1e.06 Pa must exceed return_pressure = 5e.06 Pa"):
        changed(nominal_values(), {"supply_pressure": 1e6, "return_pressure": 5e6})
    both = changed(nominal_values(), {"supply_pressure": 3e7, "return_pressure": 9e6})
    assert both["return_pressure"] == 9e6


def test_changes_leave_the_given_set_alone() -> None:
    values = nominal_values()
    changed(values, {"moving_mass": 20.0})
    assert values == nominal_values()


@pytest.mark.parametrize(
    "text",
    [
        "eha_sim:\n  ros__parameters:\n    moving_mass: 12.5\n    coulomb_friction.force: 300.0\n",
        "eha_sim:\n  ros__parameters:\n    moving_mass: 12.5\n    coulomb_friction:\n      force: 300\n",
        "/eha_sim:\n  ros__parameters: {moving_mass: 12.5, coulomb_friction: {force: 3e2}}\n",
        "/**:\n  ros__parameters:\n    moving_mass: 12.5\n    coulomb_friction.force: 300.0\n",
        "/**:\n  ros__parameters:\n    moving_mass: 7.0\n    coulomb_friction.force: 300.0\n"
        "eha_sim:\n  ros__parameters:\n    moving_mass: 12.5\n",
        "eha_sim:\n  ros__parameters:\n    moving_mass: 12.5\n    coulomb_friction.force: 300.0\n"
        "    use_sim_time: true\n    qos_overrides: {/clock: {subscription: {depth: 1}}}\n"
        "other_node:\n  ros__parameters: {gain: high}\n",
    ],
    ids=["dotted", "nested", "absolute name", "any node", "own section over any node's", "beside other settings"],
)
def test_every_form_of_a_ros_parameters_file_is_read(tmp_path: Path, text: str) -> None:
    assert load_parameters(write(tmp_path, text)) == {"moving_mass": 12.5, "coulomb_friction.force": 300.0}


@pytest.mark.parametrize("spelled", ["1e-10", "1.0e-10", "0.0000000001", "1E-10"])
def test_a_number_is_a_number_in_any_spelling(tmp_path: Path, spelled: str) -> None:
    path = write(tmp_path, f"eha_sim:\n  ros__parameters:\n    internal_leakage: {spelled}\n")
    assert load_parameters(path) == {"internal_leakage": 1e-10}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("eha_sim:\n  ros__parameters: {moving_mas: 1}\n", "no parameter named moving_mas; did you mean moving_mass"),
        ("eha_sim:\n  ros__parameters:\n    moving_mass: heavy\n", "moving_mass = 'heavy' is not a number"),
        ("eha_sim:\n  ros__parameters:\n    moving_mass: -1\n", "moving_mass = -1 kg is out of range"),
        ("eha_sim:\n  ros__parameters:\n    moving_mass: .nan\n", "moving_mass = nan is not finite"),
        ("eha_sim: [\n", "this is not YAML (line 2: "),
        ("eha_sim: {a: 1, a: *b}\n", "line 1: aliases are not read"),
        ("", "expected `eha_sim:"),
        ("- 1\n", "expected `eha_sim:"),
        ("other:\n  ros__parameters: {a: 1}\n", "no parameters for eha_sim"),
        ("eha_sim:\n  ros__parameters:\n", "no parameters for eha_sim"),
        ("eha_sim:\n  ros__parameters: {supply_pressure: 2e5, return_pressure: 3e5}\n", "must exceed"),
    ],
)
def test_a_bad_file_is_refused_in_one_line_that_names_it(tmp_path: Path, text: str, message: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(ParameterError) as caught:
        load_parameters(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="none.yaml: cannot be read \\(No such file"):
        load_parameters(tmp_path / "none.yaml")
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ParameterError, match="binary.yaml: "):
        load_parameters(tmp_path / "binary.yaml")


def test_what_is_dumped_is_what_is_loaded(tmp_path: Path) -> None:
    values = {"internal_leakage": 1e-10, "moving_mass": 9.25, "bulk_modulus": 1.4e9, "end_stop.lower": -0.013}
    text = dump_parameters(values, "first line\nsecond line")
    assert text.startswith("# first line\n# second line\n/**/eha_sim:\n  ros__parameters:\n")
    assert "1.0e-10" in text  # without its point, YAML 1.1 takes 1e-10 for text
    assert load_parameters(write(tmp_path, text)) == values


def test_no_parameter_of_the_node_is_a_group_of_others_too() -> None:
    names = {node_name(name) for name in catalogue()}
    groups = {name.rpartition(".")[0] for name in names}
    assert not names & groups
    assert "external_leakage_effect.coefficient_a" in names and "recovered_force.knots" in names


def test_the_node_s_names_lead_back_to_the_catalogue_s(tmp_path: Path) -> None:
    values = {name: float(number) for number, name in enumerate(catalogue())}
    assert from_node(to_node(values)) == values
    law = {f"recovered_force.knot_{knot:02d}": 0.5 * knot for knot in range(25)}
    text = dump_parameters({**law, "external_leakage.coefficient_b": 1e-12})
    assert text.count("recovered_force") == 1 and "external_leakage_effect.coefficient_b: 1.0e-12" in text
    assert load_parameters(write(tmp_path, text)) == {**law, "external_leakage.coefficient_b": 1e-12}
    old = "eha_sim:\n  ros__parameters: {external_leakage.coefficient_b: 1.0e-12, recovered_force.knot_02: 3.0}\n"
    assert load_parameters(write(tmp_path, old)) == {
        "external_leakage.coefficient_b": 1e-12,
        "recovered_force.knot_02": 3.0,
    }


def test_a_law_of_another_length_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="recovered_force.knots"):
        load_parameters(write(tmp_path, "eha_sim:\n  ros__parameters:\n    recovered_force.knots: [1.0, 2.0]\n"))
