"""The examples in docs/recordings.md hold."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from eha_core.recording import CHANNEL_KINDS, load_topics_file

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "docs" / "recordings.md").read_text()


def example(language: str) -> str:
    match = re.search(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)
    assert match
    return match[1]


def test_the_topics_file_parses(tmp_path: Path) -> None:
    path = tmp_path / "topics.yaml"
    path.write_text(example("yaml"))
    topics_file = load_topics_file(path)
    assert topics_file.namespace == "left"
    position, pressure = topics_file.channels["position"], topics_file.channels["pressure_b"]
    assert position is not None and (position.field, position.scale) == ("position[0]", 1e-3)
    assert pressure is not None and (pressure.topic, pressure.reference) == (None, "gauge")
    assert topics_file.channels["velocity"] is None


def test_every_channel_is_in_the_table() -> None:
    rows = [line for line in TEXT.splitlines() if line.startswith("| ")]
    named = {name.strip() for row in rows for name in row.split("|")[1].split(",")}
    assert set(CHANNEL_KINDS) <= named


def test_the_python_lines_run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    exec(compile(example("python"), os.fspath(ROOT / "docs" / "recordings.md"), "exec"), {})
    assert capsys.readouterr().out.startswith("12.0 [0.")
