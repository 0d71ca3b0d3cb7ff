"""The recordings shipped with the project: what is expected of them, and how they are diagnosed."""

from __future__ import annotations

from pathlib import Path

import pytest

from eha_core.effects import effects
from eha_core.errors import EhaError
from eha_core.exam.shipped import BAGS, show_bags
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


def test_a_folder_without_recordings_is_said(tmp_path: Path) -> None:
    with pytest.raises(EhaError, match="holds none of paper_leakage_levels"):
        show_bags(tmp_path, lambda *stage: None)
