"""`eha export fmu`: valid FMUs of both versions that give the plant's own numbers, to the last bit."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported import FIVE, advanced, values, voltages

from eha_core.cli import main
from eha_core.plant import COLUMNS, Plant, compose

pytest.importorskip("ziglang", reason="the compiler is not installed: pip install ziglang")
fmpy = pytest.importorskip("fmpy", reason="what runs FMUs is not installed: pip install fmpy")

from fmpy.model_description import ModelDescription  # noqa: E402
from fmpy.validation import validate_fmu  # noqa: E402

RENAMED = {name: f"{name}_in_force" for name in ("supply_pressure", "return_pressure", "internal_leakage")}
OUTPUTS = [RENAMED.get(name, name) for name in COLUMNS]
BINARIES = {2: ("linux64", "win64"), 3: ("x86_64-linux", "x86_64-windows")}


class Unit:
    """One instance of an FMU, under one set of names for both versions of FMI."""

    def __init__(self, path: Path, version: int) -> None:
        self.description: ModelDescription = fmpy.read_model_description(str(path))
        self.references = {one.name: one.valueReference for one in self.description.modelVariables}
        kind = {2: fmpy.fmi2.FMU2Slave, 3: fmpy.fmi3.FMU3Slave}[version]
        token = self.description.guid if version == 2 else self.description.instantiationToken
        folder = path.with_suffix("")
        if not folder.exists():
            fmpy.extract(str(path), str(folder))
        identifier = self.description.coSimulation.modelIdentifier
        self.of: Any = kind(guid=token, unzipDirectory=str(folder), modelIdentifier=identifier, instanceName="unit")
        self.version, self.time = version, 0.0
        self.of.instantiate()

    def get(self, names: Sequence[str] = OUTPUTS) -> list[float]:
        read = self.of.getReal if self.version == 2 else self.of.getFloat64
        return list(read([self.references[name] for name in names]))

    def set(self, **changes: float) -> None:
        write = self.of.setReal if self.version == 2 else self.of.setFloat64
        names = [name.replace("__", ".") for name in changes]
        write([self.references[name] for name in names], list(changes.values()))

    def begin(self, start: float = 0.0) -> None:
        self.time = start
        if self.version == 2:
            self.of.setupExperiment(startTime=start)
            self.of.enterInitializationMode()
        else:
            self.of.enterInitializationMode(startTime=start)
        self.of.exitInitializationMode()

    def step(self, voltage: float, size: float = 1e-3) -> list[float]:
        self.set(voltage_command=voltage)
        self.of.doStep(currentCommunicationPoint=self.time, communicationStepSize=size)
        self.time += size
        return self.get()


@pytest.fixture(scope="module", params=[2, 3])
def unit_file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, int]:
    """The plant with five effects, from a diagnosis, by the command line."""
    folder = tmp_path_factory.mktemp(f"fmi{request.param}")
    parts = {"source": "servo_valve", "cylinder": "double_rod", "load": "sprung_mass"}
    (folder / "diagnosis.json").write_text(
        json.dumps({"schema": "eha.diagnosis/1", "plant": parts, "fitted_values": values()})
    )
    words = ["export", "fmu", "--from", str(folder / "diagnosis.json"), "--fmi", str(request.param)]
    assert main([*words, "--out", str(folder / "rig.fmu")]) == 0
    return folder / "rig.fmu", request.param


@pytest.fixture
def unit(unit_file: tuple[Path, int]) -> Iterator[Unit]:
    made = Unit(*unit_file)
    yield made
    made.of.freeInstance()


def test_it_is_valid_and_says_what_it_holds(unit_file: tuple[Path, int]) -> None:
    path, version = unit_file
    assert validate_fmu(str(path)) == []
    described = fmpy.read_model_description(str(path))
    named = {one.name: one for one in described.modelVariables}
    assert described.fmiVersion == f"{version}.0"
    assert {name: float(named[name].start) for name in FIVE} == FIVE
    force = named["coulomb_friction.force"]
    assert (force.unit, force.causality, force.variability) == ("N", "parameter", "tunable")
    assert "friction" in force.description
    assert [one.name for one in described.modelVariables if one.causality == "output"] == OUTPUTS
    assert named["voltage_command"].causality == "input"


def test_a_minute_with_five_effects_is_the_plant_to_the_last_bit(unit_file: tuple[Path, int]) -> None:
    commands = voltages(60.0)
    signal = np.array(list(zip(1e-3 * np.arange(len(commands)), commands, strict=True)),
                      dtype=[("time", float), ("voltage_command", float)])  # fmt: skip
    found = fmpy.simulate_fmu(
        str(unit_file[0]), stop_time=60.0, step_size=1e-3, output_interval=1e-3, input=signal, output=OUTPUTS
    )
    expected = advanced(Plant(FIVE), commands)
    rows = np.stack([found[name] for name in OUTPUTS], axis=1)
    assert np.ptp(rows[:, COLUMNS.index("position")]) > 0.01
    np.testing.assert_array_equal(rows, expected)


def test_parameters_and_effects_change_while_it_runs(unit: Unit) -> None:
    changes = {"coulomb_friction.force": 0.0, "spool_hysteresis.half_width": 2e-4, "supply_pressure": 1.4e7,
               "presliding_friction.force": 200.0, "presliding_friction.static_force": 300.0,
               "presliding_friction.acts_from": 0.31, "command_delay.delay": 0.0035}  # fmt: skip
    plant, commands = Plant(FIVE, initial_position=0.02), voltages(0.6)
    unit.set(initial_position=0.02)
    unit.begin(start=5.0)
    rows = [unit.get(), *map(unit.step, commands[:200])]
    unit.set(**{name.replace(".", "__"): value for name, value in changes.items()})
    rows += map(unit.step, commands[200:])
    expected = advanced(plant, commands[:200])
    plant.set_parameters(changes)
    expected = np.concatenate([expected, advanced(plant, commands[200:])[1:]])
    np.testing.assert_array_equal(rows, expected)


def test_another_valve_is_solved_as_exactly(unit: Unit) -> None:
    changes = {"coil_resistance": 80.0, "valve_natural_frequency": 900.0, "valve_damping_ratio": 1.3}
    unit.set(**changes)
    unit.begin()
    rows = np.array([unit.get(), *map(unit.step, voltages(0.3))])
    expected = advanced(Plant({**FIVE, **changes}), voltages(0.3))
    assert np.abs(rows - expected)[:, COLUMNS.index("position")].max() < 1e-13
    np.testing.assert_allclose(rows, expected, rtol=1e-7, atol=1e-9)


def test_instances_do_not_touch_each_other_and_a_reset_is_the_beginning(unit_file: tuple[Path, int]) -> None:
    units = [Unit(*unit_file) for _ in range(3)]
    units[1].set(internal_leakage=1e-10)
    for one in units:
        one.begin()
    first, leaking, again = (np.array(rows) for rows in zip(
        *([one.step(voltage) for one in units] for voltage in voltages(0.2)), strict=True
    ))  # fmt: skip
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, leaking)
    units[1].of.terminate()
    units[1].of.reset()
    units[1].begin()
    np.testing.assert_array_equal([units[1].step(voltage) for voltage in voltages(0.2)], first)
    for one in units:
        one.of.freeInstance()


def test_a_state_is_kept_and_taken_up_again(unit: Unit) -> None:
    unit.begin()
    commands = voltages(0.2)
    for voltage in commands[:100]:
        unit.step(voltage)
    state, then = unit.of.getFMUState(), unit.time
    packed = unit.of.serializeFMUState(state)
    expected = [unit.step(voltage) for voltage in commands[100:]]
    for taken in (state, unit.of.deserializeFMUState(packed)):
        unit.of.setFMUState(taken)
        unit.time = then
        np.testing.assert_array_equal([unit.step(voltage) for voltage in commands[100:]], expected)
        unit.of.freeFMUState(taken)


def test_what_a_communication_step_is_off_does_not_add_up(unit: Unit) -> None:
    """Steps of 0.36 ms end at the plant's nearest step of 0.1 ms."""
    plant = Plant(FIVE)
    unit.begin()
    for count, voltage in enumerate(voltages(0.3)):
        row = unit.step(voltage, 0.36e-3)
        plant.advance(float(voltage), round((count + 1) * 3.6) - plant.step_count)
        assert row == list(plant.state)
    assert abs(plant.time - unit.time) <= 0.5e-4


@pytest.mark.parametrize(
    "changes, said",
    [
        ({"moving_mass": -1.0}, "moving_mass = -1 is out of range"),
        ({"moving_mass": float("nan")}, "moving_mass = nan is out of range"),
        ({"initial_position": 1.0}, "initial_position is outside the stroke"),
        ({"supply_pressure": 1e6, "return_pressure": 2e6}, "supply_pressure must exceed return_pressure"),
    ],
)
def test_values_that_make_no_plant_are_refused_in_a_line(
    unit: Unit, changes: dict[str, float], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(Exception, match="Error|failed"):
        unit.set(**changes)
        unit.begin()
    assert said in capsys.readouterr().out


def test_a_voltage_that_is_no_number_is_refused(unit: Unit) -> None:
    unit.begin()
    with pytest.raises(Exception, match="Error|failed"):
        unit.step(float("nan"))


def test_the_libraries_export_all_of_fmi(unit_file: tuple[Path, int], tmp_path: Path) -> None:
    path, version = unit_file
    linux, windows = BINARIES[version]
    headers = Path(fmpy.__file__).parent / "c-code" / f"fmi{version}Functions.h"
    wanted = set(re.findall(rf"^#define (fmi{version}[A-Z]\w+)\s+fmi{version}FullName", headers.read_text(), re.M))
    if version == 2:  # those of model exchange are apart
        wanted -= {f"fmi2{name}" for name in (
            "EnterEventMode", "NewDiscreteStates", "EnterContinuousTimeMode", "CompletedIntegratorStep", "SetTime",
            "SetContinuousStates", "GetDerivatives", "GetEventIndicators", "GetContinuousStates",
            "GetNominalsOfContinuousStates",
        )}  # fmt: skip
    assert len(wanted) > 30
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path)
    library = tmp_path / "binaries" / windows / "rig.dll"
    shown = subprocess.run(
        [sys.executable, "-m", "ziglang", "objdump", "--exports", "--imports", library],
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    assert set(re.findall(rf"fmi{version}\w+", shown)) == wanted
    assert not re.search("python|numba|NRT_", shown)
    text = (tmp_path / "binaries" / linux / "rig.so").read_bytes()
    assert all(f"{name}\0".encode() in text for name in wanted)
    assert not re.search(rb"Py[A-Z]|numba|NRT_", text)


def test_a_single_rod_with_a_step_of_its_own_starts_in_balance(tmp_path: Path) -> None:
    parts, changes = "plant: {cylinder: single_rod}", {"piston_area_b": 4e-4, "spring_stiffness": 1e4}
    values_text = ", ".join(f"{name}: {value!r}" for name, value in changes.items())
    (tmp_path / "rod.yaml").write_text(f"{parts}\n/**/eha_sim: {{ros__parameters: {{{values_text}}}}}\n")
    words = ["export", "fmu", "--nominal", str(tmp_path / "rod.yaml"), "--fmi", "3", "--step", "2.5e-5"]
    assert main([*words, "--out", str(tmp_path / "rod.fmu")]) == 0
    unit = Unit(tmp_path / "rod.fmu", 3)
    unit.set(initial_position=-0.01)
    unit.begin()
    plant = Plant(changes, 2.5e-5, -0.01, compose(cylinder="single_rod"))
    rows = [unit.get(), *map(unit.step, voltages(0.1))]
    unit.of.freeInstance()
    np.testing.assert_array_equal(rows, advanced(plant, voltages(0.1), 40))


def test_the_same_model_makes_the_same_file(unit_file: tuple[Path, int], tmp_path: Path) -> None:
    path, version = unit_file
    words = ["export", "fmu", "--from", str(path.with_name("diagnosis.json")), "--fmi", str(version)]
    assert main([*words, "--out", str(tmp_path / "rig.fmu")]) == 0
    assert (tmp_path / "rig.fmu").read_bytes() == path.read_bytes()
