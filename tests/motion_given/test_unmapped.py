"""A column that no channel uses is pointed out where the residual depends on it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from benches import TIME, position, velocity

from eha_core.motion_given import diagnose_motion
from eha_core.recording import read_recording

V = velocity(TIME)
SLOW = 40.0 + 10.0 * np.sin(2.0 * np.pi * 0.11 * TIME)
"""Oil temperature, say."""


def remarks(path: Path, force: np.ndarray, **columns: np.ndarray) -> list[str]:
    noise = np.random.default_rng(2).standard_normal(len(TIME))
    table = {"time": TIME, "position": position(TIME), "velocity": V, "force": force + noise, **columns}
    rows = np.column_stack(list(table.values()))
    np.savetxt(path, rows, delimiter=",", header=",".join(table), comments="", fmt="%.9g")
    found = diagnose_motion([read_recording(path)])
    return [remark for remark in found.diagnosis.remarks if remark.startswith("column")]


def test_a_temperature_that_friction_depends_on_is_pointed_out(tmp_path: Path) -> None:
    force = (150.0 + 4.0 * (SLOW - 40.0)) * np.sign(V) + 900.0 * V
    idle = np.random.default_rng(7).standard_normal(len(TIME))
    (said,) = remarks(tmp_path / "bench.csv", force, oil=SLOW, idle=idle)
    assert said.startswith("column 'oil' explains ")
    assert 80 < int(said.split("explains ")[1].split(" %")[0]) <= 100
    assert said.endswith('schedule: {column: "oil"}')


@pytest.mark.parametrize("column", [TIME * 500.0, 3.0 * V, np.full(len(TIME), 5.0), SLOW])
def test_a_count_a_copy_a_constant_and_an_idle_column_are_not(tmp_path: Path, column: np.ndarray) -> None:
    force = 150.0 * np.sign(V) + 900.0 * V + 30.0 * np.sin(2.0 * np.pi * 0.9 * TIME)
    assert remarks(tmp_path / "bench.csv", force, other=column) == []


def test_the_mapped_column_becomes_part_of_the_law(tmp_path: Path) -> None:
    force = (150.0 + 4.0 * (SLOW - 40.0)) * np.sign(V) + 900.0 * V
    path, topics = tmp_path / "bench.csv", tmp_path / "topics.yaml"
    assert remarks(path, force, oil=SLOW)
    topics.write_text("channels:\n  schedule: {column: oil, unit: degrees C}\n")
    found = diagnose_motion([read_recording(path, topics)])
    (dry,) = [effect for effect in found.diagnosis.effects if effect.id == "coulomb_friction"]
    assert "force grows with oil [degrees C]" in dry.statement
    values = [value.value for value in dry.parameters.values()]
    assert values == pytest.approx([110.0, 190.0], rel=0.03)
