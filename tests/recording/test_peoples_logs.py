"""Logs of the kinds that people have: read right, or asked about; never certain and false, never short in silence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from example_run import CHANNELS, COUNT, TIME
from logs_asked import ASKED
from logs_read import AS_THEY_ARE
from peoples_logs import Log

from eha_core.errors import RecordingError
from eha_core.recording import read_recording
from eha_core.recording.inspection import inspect_file
from eha_core.recording.suggestions import suggest
from eha_core.recording.topics_text import topics_text


def topics_of(path: Path, answers: dict[str, dict[str, Any] | None] | None = None) -> tuple[Path, dict[str, Any]]:
    """The topics file of a log with its questions answered, and the entries that asked."""
    inspection = inspect_file(path)
    content = yaml.safe_load(topics_text(inspection, suggest(inspection)))
    asked = {name: entry for name, entry in content["channels"].items() if isinstance(entry, dict) and "ask" in entry}
    content["channels"] |= answers or {}
    topics = path.parent / "topics.yaml"
    topics.write_text(yaml.safe_dump(content))
    return topics, asked


@pytest.mark.parametrize("kind", [*AS_THEY_ARE, *ASKED])
def test_a_log_gives_the_run_with_no_more_questions_than_it_leaves_open(tmp_path: Path, kind: str) -> None:
    log: Log = (AS_THEY_ARE | ASKED)[kind]
    path = tmp_path / log.name
    log.write(path)
    topics, asked = topics_of(path, log.answers)
    assert set(asked) == set(log.answers)
    for channel, answer in log.answers.items():
        open_keys = ("points", "rate")  # which hold what only a person can say
        chosen = {key: value for key, value in (answer or {}).items() if key not in open_keys}
        assert any(chosen.items() <= (one or {}).items() for one in asked[channel]["ask"]), asked[channel]
    recording = read_recording(path, topics)
    assert set(recording.channels) == set(CHANNELS)
    for name, expected in CHANNELS.items():
        channel = recording.channels[name]
        factor = 0.1 if kind == "low_pressures" and "pressure" in name else 1.0
        tolerance = 100.0 if "pressure" in name else 1e-6
        there = np.interp(channel.time, TIME, factor * expected)
        np.testing.assert_allclose(channel.values, there, rtol=2e-6, atol=tolerance)
        assert log.lost or len(channel.values) == COUNT
        assert channel.time[-1] > 0.98 * TIME[-1]


@pytest.mark.parametrize("kind", list(ASKED))
def test_a_log_with_an_open_question_is_not_read(tmp_path: Path, kind: str) -> None:
    path = tmp_path / ASKED[kind].name
    ASKED[kind].write(path)
    topics, asked = topics_of(path)
    with pytest.raises(RecordingError, match="in place of its `ask`") as caught:
        read_recording(path, topics)
    assert "\n" not in str(caught.value)
    assert any(entry["question"][:20] in str(caught.value) for entry in asked.values())
