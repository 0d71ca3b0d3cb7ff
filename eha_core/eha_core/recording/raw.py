"""The interface of the file formats: their topics, and sinks that take the serialised messages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class RawTopic:
    """One topic.

    Attributes:
        name: full topic name.
        type_name: "package/msg/Name".
        encoding: "ros2msg" or "ros2idl".
        definition: the type's definition as stored; empty where the file has none.
    """

    name: str
    type_name: str
    encoding: str
    definition: str


class Sink(Protocol):
    """Takes the messages of one topic in the order of the file."""

    def add(self, log_time: int, payload: bytes) -> None:
        """Take one message's CDR bytes, recorded at `log_time` [ns]."""

    def add_block(
        self, content: bytes, starts: NDArray[np.int64], lengths: NDArray[np.int64], log_times: NDArray[np.int64]
    ) -> None:
        """Take many messages, each some bytes of `content`."""


Sinks = Mapping[str, Sink]
"""The sinks of messages by topic; other topics are skipped."""


@dataclass
class RawRecording:
    """A recording's topics, metadata records, message counts by topic, and damage."""

    topics: dict[str, RawTopic] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    damage: list[str] = field(default_factory=list)
