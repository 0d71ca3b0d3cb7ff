"""`eha paper` as a user runs it."""

from __future__ import annotations

import contextlib
import io
import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from eha_core.cli import main
from eha_core.paper import LEVELS, PRINTED_RMSE, as_json, reproduce
from eha_core.report.paper_figures import draw_paper_figures

FIGURES = ("figure_3_displacement", "figure_4_error", "figure_5_rmse")


@pytest.fixture(scope="module")
def reproduced(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder that one run of the command fills, and what it prints."""
    folder = tmp_path_factory.mktemp("paper") / "new" / "folder"
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert main(["paper", "--out", str(folder)]) == 0
    return folder, printed.getvalue()


def test_writes_table_and_figures_and_names_the_assumptions(reproduced: tuple[Path, str]) -> None:
    folder, printed = reproduced
    table = json.loads((folder / "table.json").read_text())
    assert [row["internal_leakage"] for row in table["levels"]] == list(LEVELS)
    assert [row["printed"] for row in table["levels"]] == list(PRINTED_RMSE)
    assert table == as_json(reproduce().levels)
    for name in FIGURES:
        assert (folder / f"figures/{name}.png").read_bytes().startswith(b"\x89PNG")
        assert ElementTree.parse(folder / f"figures/{name}.svg").getroot().tag.endswith("svg")
    assert "Assumed" in printed
    assert "| computed / printed |" in printed


def test_same_result_gives_the_same_bytes(reproduced: tuple[Path, str], tmp_path: Path) -> None:
    folder, _ = reproduced
    reproduction = reproduce()
    again = draw_paper_figures(reproduction.levels, tmp_path, reproduction.sweep)
    assert len(again) == 2 * len(FIGURES)
    for path in again:
        assert path.read_bytes() == (folder / "figures" / path.name).read_bytes()


def test_folder_that_cannot_be_made_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    assert main(["paper", "--out", str(tmp_path / "file" / "folder")]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "file" in message
    assert "--out" in message
