"""What reading hands on cannot be changed by those who get it."""

from __future__ import annotations

from dataclasses import FrozenInstanceError

import pytest

from eha_core.recording import (
    blocks,
    channel_rules,
    inspection,
    reader,
    samples,
    simulated,
    suggestions,
    topic_columns,
    topics_file,
)
from eha_core.recording import recording as recordings

KINDS = [
    blocks.Block, channel_rules.ChannelRule, topics_file.TopicsFile, inspection.Field, inspection.Inspection,
    reader.MessageFile, recordings.Channel, recordings.ChannelKind, recordings.Recording, samples.Samples,
    simulated.Experiment, simulated.Simulated, suggestions.Question, suggestions.Reading, suggestions.Suggestions,
    topic_columns.DecodedTopic,
]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_can_be_set(kind: type) -> None:
    one = kind.__new__(kind)
    with pytest.raises(FrozenInstanceError):
        one.path = "another"
