"""What is tried and its residual, on a terminal, in a file; and paths that are checked before any work."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import pytest

from eha_core.cli import main
from eha_core.cli._progress import NOW_AND_THEN, Progress

BAG = str(Path(__file__).parents[2] / "bags" / "rig_coulomb_friction.mcap")


class Terminal(StringIO):
    def isatty(self) -> bool:
        return True


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_a_terminal_shows_what_is_tried_and_what_is_left_in_one_line() -> None:
    out, clock = Terminal(), Clock()
    progress = Progress(out=out, clock=clock)
    clock.now += 12.0
    progress("refitting with coulomb_friction")
    assert out.getvalue() == ("\r\x1b[K  12 s [##>..] search: refitting with coulomb_friction; left: intervals, report")
    progress.end()
    assert out.getvalue().endswith("\r\x1b[K")


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        ("reading hour.mcap: 30 s", "[>.....] reading"),
        ("calibrating the nominal equations", "[#>....] calibration"),
        ("once more: bulk_modulus went as far as believed of it", "[#>....] calibration"),
        ("anything else", "[##>...] search"),
        ("polishing the winner and its intervals", "[###>..] intervals"),
        ("judging the model on the whole of hour.mcap: 30 of 3600 s", "[####>.] whole record"),
        ("writing the report", "[#####>] report"),
    ],
)
def test_each_message_has_its_place(message: str, expected: str) -> None:
    placed = Progress(long=True, out=Terminal()).placed(message)
    assert placed.startswith(f"{expected}: {message}")
    assert ("left: " in placed) is (message != "writing the report")


def test_a_file_gets_a_line_now_and_then() -> None:
    out, clock = StringIO(), Clock()
    progress = Progress(out=out, clock=clock)
    progress("refitting with coulomb_friction")
    assert out.getvalue() == ""
    for _ in range(10):
        clock.now += 0.3 * NOW_AND_THEN
        progress("trying constant_load")
    lines = out.getvalue().splitlines()
    assert len(lines) == 2
    assert lines[0].startswith("eha diagnose: 12 s [##>..] search: trying constant_load; left: intervals")


def test_a_log_gets_every_message_with_its_time(tmp_path: Path) -> None:
    clock = Clock()
    progress = Progress(log=tmp_path / "what.log", out=StringIO(), clock=clock)
    progress("reading and aligning")
    clock.now += 1.5
    progress("trying constant_load")
    progress.end()
    first, second = (tmp_path / "what.log").read_text(encoding="utf-8").splitlines()
    assert first.startswith("    0.0 s  [>....] reading: reading and aligning")
    assert second.startswith("    1.5 s  [##>..] search: trying constant_load")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--out", "{file}/report"], "{file}: cannot be written (Not a directory); choose another --out"),
        (["--json", "{folder}/none/it.json"], "cannot be written (No such file or directory); choose another --json"),
        (["--json", "{folder}"], "{folder}: cannot be written (Is a directory); choose another --json"),
        (["--log", "{folder}/none/it.log"], "cannot be written (No such file or directory); choose another --log"),
        (["--nominal", "{folder}/none.yaml"], "none.yaml"),
        (["--topics", "{folder}/none.yaml"], "none.yaml"),
        (["--test", "{folder}/none.mcap"], "{folder}/none.mcap: there is no such file or folder"),
    ],
)
def test_paths_are_checked_before_any_work(
    words: list[str], expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "file"
    file.write_text("in the way", encoding="utf-8")
    places = {"file": file, "folder": tmp_path}

    def read(*_: object) -> None:
        raise AssertionError("a recording was read")

    monkeypatch.setattr("eha_core.long_record.admission.read_recording", read)
    monkeypatch.chdir(tmp_path)
    assert main(["diagnose", BAG, *(word.format(**places) for word in words)]) == 2
    said = capsys.readouterr().err
    assert expected.format(**places) in said
    assert said.count("\n") == 1
