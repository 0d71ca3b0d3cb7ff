"""`import eha_core as eha`: light to import, and the same answers as the command line."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import eha_core as eha
from eha_core.cli import main
from eha_core.effects import effects
from eha_core.errors import EhaError
from eha_core.recording import read_recording
from eha_core.report.summary_tables import summarise

COMMAND = "multisine:amplitude=0.12,lowest=0.3,highest=8,count=16,period=20,seed=3"
RIG = {"coulomb_friction.force": 250.0, "moving_mass": 11.0}


@pytest.fixture(scope="module")
def found() -> eha.Results:
    """A diagnosis of a data frame, with all that it takes: five lines."""
    frame = pd.DataFrame(eha.simulate(COMMAND, 6.0, RIG, noise=1.0).to_dict())
    recording = eha.Recording.from_dataframe(frame, pressures="gauge", name="rig")
    return eha.diagnose(recording)


def test_importing_loads_neither_compilers_nor_numpy() -> None:
    code = "import sys, eha_core, eha_core.cli; print(sorted({'numpy', 'numba', 'matplotlib'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == "[]"


def test_every_public_name_is_there() -> None:
    assert set(eha.__all__) <= set(dir(eha))
    for name in eha.__all__:
        assert getattr(eha, name).__doc__ or name == "__version__"
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        eha.simulat  # noqa: B018


def test_a_data_frame_is_diagnosed_in_five_lines(found: eha.Results) -> None:
    (effect,) = found.effects
    assert found.verdict == "missing_physics"
    assert effect.id == "coulomb_friction"
    force = effect.parameters["force"]
    assert abs(force.value - 250.0) < 4.0 * force.std < 4.0
    assert found.fitted_values["coulomb_friction.force"] == force.value


def test_a_recording_that_cannot_be_right_is_no_missing_physics() -> None:
    """A position that counts the other way is reported before any fit, as on the command line, and can be overruled."""
    made = eha.simulate(COMMAND, 2.0, noise=1.0)
    frame = pd.DataFrame(made.to_dict()).assign(position=lambda columns: -columns["position"])
    recording = eha.Recording.from_dataframe(frame.drop(columns="velocity"), pressures="gauge", name="rig")
    with pytest.raises(EhaError, match=r"^rig: position .*; as_recorded=True continues all the same$"):
        eha.diagnose(recording)

    def stop(stage: str) -> None:
        raise InterruptedError(stage)

    with pytest.raises(InterruptedError, match="reading"):
        eha.diagnose(recording, as_recorded=True, progress=stop)


def test_the_summary_has_the_interval_and_the_errors(found: eha.Results) -> None:
    text = str(found.summary())
    force = found.effects[0].parameters["force"]
    row = next(line for line in text.splitlines() if line.startswith("coulomb_friction.force")).split()
    value, deviation, low, high = (float(cell) for cell in row[1:5])
    assert (value, deviation) == (pytest.approx(force.value, rel=1e-4), pytest.approx(force.std, rel=0.06))
    assert (low, high) == pytest.approx((force.value - 1.96 * force.std, force.value + 1.96 * force.std), rel=1e-4)
    assert "augmented / noise" in text
    assert max(map(len, text.splitlines())) <= 96
    assert "coulomb_friction.force" in found._repr_html_()


def test_a_remark_in_the_summary_names_its_channel_in_words(found: eha.Results) -> None:
    remarked = replace(found.diagnosis, remarks=("pressure_b: 3 outliers were excluded",))
    assert "Pressure of chamber B: 3 outliers were excluded." in str(summarise(remarked))


def test_json_plots_and_files(found: eha.Results, tmp_path: Path) -> None:
    text = found.to_json(tmp_path / "diagnosis.json")
    assert json.loads(text)["schema"] == "eha.diagnosis/1"
    assert (tmp_path / "diagnosis.json").read_text() == text
    for name in ("recording", "parameters", "equations", "evidence", "law", "residuals", "whiteness"):
        assert getattr(found.plot, name)()._repr_png_().startswith(b"\x89PNG")
    assert (tmp_path / "out" / "report.html") in found.save(tmp_path / "out")


def test_simulating_is_what_the_command_line_records(tmp_path: Path) -> None:
    words = ["--command", "sine:amplitude=0.02,frequency=2", "--duration", "1", "--noise", "1", "--seed", "5"]
    assert main(["simulate", *words, "--set", "moving_mass=11", "--out", str(tmp_path / "run.mcap")]) == 0
    written = read_recording(tmp_path / "run.mcap")
    made = eha.simulate("sine:amplitude=0.02,frequency=2", 1.0, {"moving_mass": 11.0}, noise=1.0, seed=5)
    assert made.parameters == written.parameters
    for name, channel in made.channels.items():
        np.testing.assert_allclose(channel.values, written.channels[name].values, rtol=0, atol=1e-7)
        np.testing.assert_allclose(channel.time, written.channels[name].time, rtol=0, atol=1e-9)


def test_voltages_drive_as_a_signal_of_the_same_values_does() -> None:
    volts = 0.02 * np.sin(2 * np.pi * 2.0 * np.arange(500) / 500.0)
    one, other = eha.simulate(volts), eha.simulate("sine:amplitude=0.02,frequency=2", 1.0)
    np.testing.assert_allclose(one.channels["position"].values, other.channels["position"].values, rtol=0, atol=1e-12)
    states = eha.simulate(volts, states=True)
    assert {"spool", "flow_a", "current", "supply_pressure"} <= set(states.channels) - set(one.channels)
    with pytest.raises(eha.ParameterError, match="one voltage for each sample"):
        eha.simulate(np.zeros((3, 2)))


def test_values_in_the_names_of_the_parts_that_a_recording_carries_are_taken() -> None:
    time = np.arange(100) / 200.0
    recording = eha.Recording.from_arrays(time=time, position=0.1 * np.sin(time), voltage_command=np.cos(time))
    turning = replace(recording, parts={"cylinder": "rotary_vane"})
    with pytest.raises(EhaError, match=r"0\.495 s of data are too short"):
        eha.diagnose(turning, {"moment_of_inertia": 0.4})
    with pytest.raises(EhaError, match="moment_of_inertia does not apply to this plant"):
        eha.diagnose(recording, {"moment_of_inertia": 0.4})


def test_the_catalogue_lists_every_named_effect_with_its_docstring() -> None:
    listed = eha.catalogue()
    assert set(listed) == {effect.id for effect in effects() if effect.named}
    assert "Source:" in str(listed["stribeck_friction"])
    assert "coulomb_friction" in repr(listed)
    assert "<td>" in listed._repr_html_()
    assert "frequency [Hz]" in str(eha.signal_shapes()["sine"])


def test_given_motion_goes_its_own_way_as_on_the_command_line(tmp_path: Path) -> None:
    """80 N of dry and 900 N s/m of viscous friction on a bench that nothing but its motion drives."""
    time = np.arange(4000) / 500.0
    speed = 0.1 * np.cos(2.0 * np.pi * 0.8 * time) + 0.05 * np.cos(2.0 * np.pi * 1.7 * time)
    force = 80.0 * np.sign(speed) + 900.0 * speed + np.random.default_rng(1).standard_normal(len(time))
    bench = eha.Recording.from_arrays(
        time=time, position=np.cumsum(speed) / 500.0, velocity=speed, force=force, name="bench"
    )
    diagnosed = eha.diagnose(bench)
    values = {effect.id: effect.parameters for effect in diagnosed.effects}
    assert set(values) == {"viscous_friction", "coulomb_friction"}
    assert values["coulomb_friction"]["force"].value == pytest.approx(80.0, rel=0.02)
    assert diagnosed.diagnosis.provenance["nominal"].startswith("none: the motion is given")
    assert diagnosed.plot.law().axes
    with pytest.raises(EhaError, match="there is no plot 'residuals'"):
        diagnosed.plot.residuals()
    assert {path.name for path in diagnosed.save(tmp_path)} == {"figures", "diagnosis.json", "report.html"}
