"""The schedule: a channel in whatever unit its column has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eha_core.errors import RecordingError
from eha_core.recording import read_recording
from eha_core.recording.topics_file import load_topics_file

TIME = np.arange(400) / 200.0
TABLE = np.column_stack([TIME, 0.01 * np.sin(TIME), 20.0 * np.cos(TIME), 35.0 + TIME])


def write(folder: Path, entry: str) -> tuple[Path, Path]:
    log, topics = folder / "log.csv", folder / "topics.yaml"
    np.savetxt(log, TABLE, delimiter=",", header="time,position,force,oil", comments="", fmt="%.9g")
    topics.write_text(f"channels:\n  schedule: {entry}\n")
    return log, topics


@pytest.mark.parametrize("unit", ["A", "degrees C", "bar", "turns"])
def test_its_numbers_stay_as_recorded_and_its_unit_is_a_name(tmp_path: Path, unit: str) -> None:
    log, topics = write(tmp_path, f"{{column: oil, unit: {unit}}}")
    channel = read_recording(log, topics).channels["schedule"]
    np.testing.assert_allclose(channel.values, TABLE[:, 3])
    assert channel.rule is not None
    assert (channel.rule.column, channel.rule.unit) == ("oil", unit)


def test_it_may_be_scaled(tmp_path: Path) -> None:
    log, topics = write(tmp_path, "{column: oil, scale: 0.1, offset: -3.0}")
    np.testing.assert_allclose(read_recording(log, topics).channels["schedule"].values, 0.1 * TABLE[:, 3] - 3.0)


def test_other_channels_still_refuse_a_unit_of_another_quantity(tmp_path: Path) -> None:
    _, topics = write(tmp_path, "{column: oil}\n  force: {column: force, unit: bar}")
    with pytest.raises(RecordingError, match="bar is not a unit of it"):
        load_topics_file(topics)
