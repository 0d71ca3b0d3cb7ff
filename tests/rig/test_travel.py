"""A travel that no cylinder has is refused, and what is assumed without a nominal file is said."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np
import pytest

from eha_core.cli import main
from eha_core.cli.diagnose import assumed_cylinder
from eha_core.errors import RecordingError
from eha_core.nominal import nominal_of
from eha_core.recording import Recording
from eha_core.rig import require_possible_travel


@pytest.mark.parametrize("bore", [0.025, 0.04, 0.2])
def test_sixty_bores_are_possible_and_more_are_not(bore: float) -> None:
    area = pi / 4.0 * bore**2
    require_possible_travel("run", 59.9 * bore, area, True)
    with pytest.raises(RecordingError, match="of travel cannot be on a piston of"):
        require_possible_travel("run", 60.1 * bore, area, True)


def test_metres_for_millimetres_are_refused_before_any_fit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """5.7 m of travel on a piston of 6 cm^2."""
    path = tmp_path / "run.csv"
    time = np.arange(400) * 1e-3
    rows = [f"{t:.3f},{np.sin(20 * t):.5f},{2.85 * np.sin(20 * t):.5f},6e6,6e6" for t in time]
    path.write_text("\n".join(["time,voltage_command,position,pressure_a,pressure_b", *rows]) + "\n")
    assert main(["diagnose", str(path)]) == 2
    (line,) = capsys.readouterr().err.strip().split("\n")
    assert "5.7 m of travel cannot be on a piston of" in line and "which is the catalogue's" in line


def test_nothing_is_assumed_where_the_model_is_known() -> None:
    time = np.arange(100) * 1e-3
    recording = Recording.from_arrays(time=time, position=0.01 * np.sin(time))
    model = nominal_of({})
    assert assumed_cylinder(True, recording, model) == ""
    assert assumed_cylinder(False, recording, model) == "of 6.45 cm^2 and 200 mm stroke"
