"""The recordings shipped with the project: what is expected of them, and how they are diagnosed."""

from __future__ import annotations

from pathlib import Path

import pytest

from eha_core.cli import main
from eha_core.effects import effects
from eha_core.errors import EhaError
from eha_core.known_answers.shipped import BAGS, show_bags

SHIPPED = Path(__file__).parents[2] / "bags"


def test_every_shipped_rig_recording_has_an_answer_that_the_catalogue_can_give() -> None:
    assert {path.name for path in SHIPPED.glob("*.mcap")} == set(BAGS)
    known = {effect.id for effect in effects()}
    assert all(expected <= known for _, expected in BAGS.values())


def test_a_shipped_recording_is_diagnosed_as_a_user_would(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "rig_as_modelled.mcap").symlink_to(SHIPPED / "rig_as_modelled.mcap")
    assert main(["exam", "--bags", str(tmp_path), "--out", str(tmp_path / "out"), "--require", "1"]) == 0
    row = "| rig_as_modelled.mcap | nothing | consistent | - | yes |"
    assert row in (tmp_path / "out/bags/table.md").read_text()
    printed = capsys.readouterr()
    assert row in printed.out and "shipped recordings: 1 of 1" in printed.err
    assert not (tmp_path / "out/recordings").exists()  # no case is made


def test_a_folder_without_recordings_is_said(tmp_path: Path) -> None:
    with pytest.raises(EhaError, match="holds none of paper_leakage_levels"):
        show_bags(tmp_path, lambda *stage: None)
