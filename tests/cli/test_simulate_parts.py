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
