"""Recordings that the exam did not make: what is expected of them, and the measured axis simulated open loop."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eha_core.effects import effects
from eha_core.errors import EhaError
from eha_core.exam.real import BAGS, open_loop_error, show_bags, show_emps
from eha_core.exam.tables import as_markdown

SHIPPED = Path(__file__).parents[2] / "bags"


def test_every_shipped_rig_recording_has_an_answer_that_the_catalogue_can_give() -> None:
    assert {path.name for path in SHIPPED.glob("*.mcap")} == set(BAGS)
    known = {effect.id for effect in effects()}
    assert all(expected <= known for _, expected in BAGS.values())


def test_a_shipped_recording_is_diagnosed_as_a_user_would(tmp_path: Path) -> None:
    (tmp_path / "rig_as_modelled.mcap").symlink_to(SHIPPED / "rig_as_modelled.mcap")
    stages: list[tuple[str, int, int]] = []
    shown = show_bags(tmp_path, lambda *stage: stages.append(stage))
    assert [(one.recording, one.source, one.verdict, one.right) for one in shown] == [
        ("rig_as_modelled.mcap", "simulated", "consistent", True)
    ]
    assert stages == [("shipped recordings", 1, 1)]
    assert "| rig_as_modelled.mcap | simulated | nothing | consistent | - | yes |" in as_markdown([], {}, shown)


def test_folders_without_the_data_are_said(tmp_path: Path) -> None:
    with pytest.raises(EhaError, match="holds none of paper_leakage_levels"):
        show_bags(tmp_path, lambda *stage: None)
    with pytest.raises(EhaError, match="has no DATA_EMPS.mat"):
        show_emps(tmp_path, lambda *stage: None)


def test_open_loop_simulation_against_closed_forms() -> None:
    time = np.arange(20001) / 10000.0
    mass, damping, friction, load = 10.0, 50.0, 4.0, -3.0
    law = {"mass": mass, "damping": damping, "friction": friction, "load": load}
    held = {"t": time, "position": np.zeros_like(time), "force": np.full_like(time, load + 0.9 * friction)}
    assert open_loop_error(held, law) == 0.0
    net = 20.0 - load - friction
    slide = net / damping * (time - mass / damping * (1.0 - np.exp(-damping / mass * time)))
    pushed = {"t": time, "position": slide, "force": np.full_like(time, 20.0)}
    assert open_loop_error(pushed, law) < 1e-4 * slide[-1]
