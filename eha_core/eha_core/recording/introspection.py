"""Names of the values that ros2_control's introspection publishes: on a topic of their own, by version.

The controller manager publishes `introspection_data/names` only when the names change, and `introspection_data/values`
after every cycle; both carry `names_version` (pal_statistics_msgs).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.serde import SerdeError

from eha_core.recording.bag import read_bag
from eha_core.recording.fields import Tables, is_named_by_version, names_topic
from eha_core.recording.message_types import recorded_types
from eha_core.recording.raw import RawTopic

MOST_VERSIONS = 256
"""Most messages of names that are read; a controller manager sends one whenever an interface is added or removed."""


def value_names(path: Path, topics: Mapping[str, RawTopic], topic: str) -> Tables:
    """The names of a topic's values by version; empty for a topic of another type, or where no names were recorded.

    Raises:
        RecordingError: the type of the names is neither defined in the recording nor installed.
    """
    names = topics.get(names_topic(topic))
    if names is None or not is_named_by_version(topics[topic].type_name):
        return {}
    sink = _Names(names)
    read_bag(path, {names.name: sink})
    return sink.tables


class _Names:
    """Takes the messages of a topic of names."""

    def __init__(self, topic: RawTopic) -> None:
        self.tables: dict[int, tuple[str, ...]] = {}
        self._type_name = topic.type_name
        self._store, _ = recorded_types(topic.type_name, topic.encoding, topic.definition)

    def add(self, log_time: int, payload: bytes) -> None:
        if len(self.tables) >= MOST_VERSIONS:
            return
        try:
            message: Any = self._store.deserialize_cdr(payload, self._type_name)
            self.tables[int(message.names_version)] = tuple(message.names)
        except (SerdeError, AttributeError, TypeError, ValueError):
            return

    def add_block(
        self, content: bytes, starts: NDArray[np.int64], lengths: NDArray[np.int64], log_times: NDArray[np.int64]
    ) -> None:
        for start, length in zip(starts.tolist(), lengths.tolist(), strict=True):
            self.add(0, content[start : start + length])
