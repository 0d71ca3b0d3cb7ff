"""`eha simulate` of actuators that a nominal file puts together."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eha_core.cli import main
from eha_core.recording import read_recording

RIG = "/**/eha_sim:\n  ros__parameters:\n    plant: {{{plant}}}\n{values}"


def rig(folder: Path, plant: str, **values: float) -> str:
    path = folder / "rig.yaml"
    path.write_text(RIG.format(plant=plant, values="".join(f"    {name}: {value}\n" for name, value in values.items())))
    return str(path)


def simulate(out: Path, command: str, nominal: str, *words: str) -> int:
    return main(["simulate", "--command", command, "--out", str(out), "--nominal", nominal, *words])


@pytest.mark.parametrize("ending", [".mcap", ".csv"])
def test_a_single_rod_on_a_symmetric_valve_extends_faster_by_the_root_of_its_areas(tmp_path: Path, ending: str) -> None:
    nominal = rig(tmp_path, "cylinder: single_rod", piston_area=1.2e-3, piston_area_b=7.8e-4, internal_leakage=0.0)
    out = tmp_path / f"run{ending}"
    assert simulate(out, "square:amplitude=0.05,frequency=0.5", nominal, "--duration", "2") == 0
    speed = read_recording(out).channels["velocity"].values
    at = speed[400], speed[900]
    # extending, the valve meters the smaller flow out; viscous damping, the same both ways, takes 85 N of 10 kN
    assert -at[0] / at[1] == pytest.approx(np.sqrt(1.2 / 0.78), rel=0.01)


def test_a_part_that_there_is_not_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nominal = rig(tmp_path, "cylinder: singlerod")
    assert simulate(tmp_path / "run.csv", "sine:amplitude=0.01,frequency=1", nominal) == 2
    assert "rig.yaml: plant.cylinder = singlerod is unknown; did you mean single_rod?" in capsys.readouterr().err


def test_a_parameter_of_another_part_is_refused_by_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nominal = rig(tmp_path, "source: measured_spool", coil_resistance=90.0)
    assert simulate(tmp_path / "run.csv", "sine:amplitude=1e-4,frequency=1", nominal) == 2
    error = capsys.readouterr().err
    assert "rig.yaml: coil_resistance does not apply to this plant (measured_spool, double_rod, sprung_mass)" in error
    assert error.count("\n") == 1


def test_a_recorded_spool_drives_the_plant_as_the_voltage_that_moved_it(tmp_path: Path) -> None:
    """A run on a servo valve, its spool recorded, and that spool in place of the valve's dynamics."""
    first, second = tmp_path / "first.csv", tmp_path / "second.csv"
    whole = rig(tmp_path, "cylinder: single_rod", piston_area=1.2e-3, piston_area_b=7.8e-4)
    assert simulate(first, "sine:amplitude=0.05,frequency=1", whole, "--duration", "2", "--rate", "2000") == 0
    part = rig(tmp_path, "source: measured_spool, cylinder: single_rod", piston_area=1.2e-3, piston_area_b=7.8e-4)
    assert simulate(second, str(first), part, "--duration", "2", "--rate", "2000") == 0
    one, two = read_recording(first), read_recording(second)
    assert set(two.channels) == {"spool", "flow_a", "flow_b", "pressure_a", "pressure_b", "supply_pressure", "position",
                                 "velocity"}  # fmt: skip
    # the recorded spool is interpolated between samples 0.5 ms apart, a tenth of a radian of its own frequency
    gap = one.channels["position"].values - two.channels["position"].values
    assert np.max(np.abs(gap)) < 2e-6


def test_recorded_flows_and_pressures_drive_it(tmp_path: Path) -> None:
    first = tmp_path / "first.csv"
    areas = {"piston_area": 1.2e-3, "piston_area_b": 7.8e-4}
    whole = rig(tmp_path, "cylinder: single_rod", **areas)
    assert simulate(first, "sine:amplitude=0.05,frequency=1", whole, "--duration", "2", "--rate", "2000") == 0
    position = read_recording(first).channels["position"].values
    for source in ("measured_flow", "measured_pressures"):
        out = tmp_path / f"{source}.csv"
        nominal = rig(tmp_path, f"{{source: {source}, cylinder: single_rod}}".strip("{}"), **areas)
        assert simulate(out, str(first), nominal, "--duration", "2", "--rate", "2000") == 0
        assert np.max(np.abs(read_recording(out).channels["position"].values - position)) < 2e-5


def test_a_pump_takes_a_signal_for_its_speed(tmp_path: Path) -> None:
    nominal = rig(
        tmp_path, "source: switched_pump, cylinder: single_rod", piston_area=1.2e-3, piston_area_b=7.8e-4,
        pump_displacement=1.6e-6, pump_leakage=0.0, internal_leakage=0.0,
    )  # fmt: skip
    out = tmp_path / "run.csv"
    assert simulate(out, "square:amplitude=30,frequency=0.5", nominal, "--duration", "2") == 0
    recording = read_recording(out)
    speed = recording.channels["velocity"].values
    assert speed[450] == pytest.approx(1.6e-6 * 30.0 / 1.2e-3, rel=1e-5)
    assert speed[950] == pytest.approx(-1.6e-6 * 30.0 / 7.8e-4, rel=1e-5)
    assert recording.channels["pump_speed"].unit == "rad/s"


def test_a_source_of_two_inputs_wants_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nominal = rig(tmp_path, "source: measured_flow")
    assert simulate(tmp_path / "run.csv", "sine:amplitude=1e-5,frequency=1", nominal) == 2
    assert "measured_flow takes flow_a and flow_b, a signal is one of them; give a file" in capsys.readouterr().err


def test_a_file_without_the_sources_channel_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "log.csv").write_text("time,position,voltage_command\n0,0,0\n0.1,0,0.01\n0.2,0,0\n")
    nominal = rig(tmp_path, "source: measured_spool")
    assert simulate(tmp_path / "run.csv", str(tmp_path / "log.csv"), nominal) == 2
    assert "log.csv: no spool was recorded; a topics file (--topics) can name the topic" in capsys.readouterr().err


def test_only_a_voltage_is_recorded_as_topics(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nominal = rig(tmp_path, "source: measured_spool")
    assert simulate(tmp_path / "run.mcap", "sine:amplitude=1e-4,frequency=1", nominal) == 2
    assert "run.mcap: a plant on measured_spool is recorded as .csv alone" in capsys.readouterr().err


def test_a_sweep_of_a_composition(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nominal = rig(tmp_path, "source: measured_spool, cylinder: rotary_vane")
    words = ("--duration", "0.5", "--sweep", "moment_of_inertia=0.2:2:3")
    assert simulate(tmp_path / "run.csv", "sine:amplitude=1e-4,frequency=2", nominal, *words) == 0
    assert "3 x 0.5 s simulated" in capsys.readouterr().out
    assert [path.name for path in sorted(tmp_path.glob("run*"))] == ["run-1.csv", "run-2.csv", "run-3.csv"]
