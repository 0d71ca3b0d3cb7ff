"""What the file formats hand over: messages by topic, not decoded yet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

TopicFilter = Callable[[str], bool]


@dataclass
class RawTopic:
    """The messages of one topic in the order of the file.

    Attributes:
        name: full topic name.
        type_name: "package/msg/Name".
        encoding: "ros2msg" or "ros2idl".
        definition: the type's definition as stored; empty where the file has none.
        log_times: when each message was recorded [ns].
        payloads: each message's CDR bytes.
    """

    name: str
    type_name: str
    encoding: str
    definition: str
    log_times: list[int] = field(default_factory=list)
    payloads: list[bytes] = field(default_factory=list)


@dataclass
class RawRecording:
    """All topics of a recording (messages only of those asked for), its metadata records, and what was damaged."""

    topics: dict[str, RawTopic] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    damage: list[str] = field(default_factory=list)
