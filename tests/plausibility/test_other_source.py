"""Recordings whose channels speak against the plant's source: found, with the line that names another; others pass."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eha_core as eha
from eha_core.cli import main
from eha_core.errors import RecordingError
from eha_core.nominal import nominal_of
from eha_core.plant import PAPER, compose
from eha_core.plausibility import admit, contradiction

TIME = np.arange(4000) / 500.0
WAVE = np.sin(2.0 * np.pi * TIME) + 0.3 * np.sin(2.0 * np.pi * 3.1 * TIME)
NOISE = np.random.default_rng(4).standard_normal((3, len(TIME)))
FLOWS = {"flow_a": 645e-6 * 0.1 * WAVE, "flow_b": 645e-6 * 0.1 * WAVE}
PRESSURES = {"pressure_a": 1e7 + 1e6 * WAVE + 1e4 * NOISE[0], "pressure_b": 1e7 - 1e6 * WAVE + 1e4 * NOISE[1]}


def recording(**channels: np.ndarray) -> eha.Recording:
    position = 0.1 * np.cumsum(WAVE) / 500.0
    return eha.Recording.from_arrays(
        time=TIME, pressures="gauge", position=position - position.mean() + 1e-5 * NOISE[2], **channels
    )


def test_a_pumps_speed_speaks_against_a_constant_supply() -> None:
    made = recording(voltage_command=10.0 * np.sign(WAVE), pump_speed=100.0 + WAVE, **PRESSURES)
    found = contradiction(made, PAPER)
    assert found is not None and "pump_speed" in found.what
    assert found.line == "plant: {source: switched_pump}"
    assert contradiction(made, compose("switched_pump", "single_rod")) is None
    held = recording(voltage_command=WAVE, pump_speed=100.0 + WAVE, supply_pressure=2.1e7 + 1e4 * NOISE[0])
    assert contradiction(held, PAPER) is None


@pytest.mark.parametrize("spool", [0.0 * TIME, 1e-6 * NOISE[1]], ids=["constant", "noise"])
def test_flow_without_the_spools_motion(spool: np.ndarray) -> None:
    found = contradiction(recording(spool=spool, **FLOWS), compose("measured_spool"))
    assert found is not None and "flow_a" in found.what and "spool" in found.what
    assert found.line == "plant: {source: measured_flow}"
    also = contradiction(recording(voltage_command=WAVE, spool=spool, **FLOWS), PAPER)
    assert also is not None and "spool" in also.what


def test_pressures_that_move_without_a_command() -> None:
    found = contradiction(recording(voltage_command=0.0 * TIME + 0.01, **PRESSURES), PAPER)
    assert found is not None and "pressure_a" in found.what and "voltage_command" in found.what
    assert found.line == "plant: {source: measured_pressures}"


def test_what_a_valve_brings_about_passes() -> None:
    assert contradiction(recording(spool=1e-3 * WAVE, **FLOWS), compose("measured_spool")) is None
    late = np.roll(WAVE, -25)
    assert contradiction(recording(voltage_command=late, **FLOWS, **PRESSURES), PAPER) is None
    simulated = eha.simulate("multisine:amplitude=0.1,lowest=0.3,highest=8,count=16,period=20,seed=3", 4.0, states=True)
    assert contradiction(simulated, PAPER) is None


def test_a_recording_is_refused_in_one_line_or_taken_with_a_warning() -> None:
    made = recording(voltage_command=10.0 * np.sign(WAVE), pump_speed=100.0 + WAVE, **PRESSURES)
    values = nominal_of({}).values
    with pytest.raises(RecordingError, match=r"\{source: switched_pump\}`; --as-recorded continues all the same"):
        admit(made, values)
    assert admit(made, values, as_recorded=True).remarks[0].startswith("warning: taken as recorded, although pump_spe")


def test_the_command_line_ends_with_status_2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rig.csv"
    columns = recording(voltage_command=10.0 * np.sign(WAVE), pump_speed=100.0 + WAVE, **PRESSURES).to_dict()
    np.savetxt(path, np.stack(list(columns.values()), axis=1), delimiter=",", header=",".join(columns), comments="")
    assert main(["diagnose", str(path), "--out", str(tmp_path / "out")]) == 2
    line = capsys.readouterr().err.strip()
    assert "\n" not in line and "plant: {source: switched_pump}" in line
