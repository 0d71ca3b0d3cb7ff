"""Reads a recording of any kind into channels: SI units, gauge pressures, one time axis."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from eha_core.errors import RecordingError
from eha_core.recording.assembly import PARTS, STANDARD_ATMOSPHERE, assembled
from eha_core.recording.bag import bag_topics, read_bag
from eha_core.recording.channel_rules import ChannelRule
from eha_core.recording.clocks import on_one_clock, without_leaps
from eha_core.recording.discovery import LEAKAGE_TOPIC, find_rules, leakage_topic
from eha_core.recording.introspection import value_names
from eha_core.recording.raw import RawRecording
from eha_core.recording.recording import Recording
from eha_core.recording.samples import Samples
from eha_core.recording.table_file import channels_of
from eha_core.recording.topic_columns import TopicColumns
from eha_core.recording.topics_file import TopicsFile, topics_of
from eha_core.tables import is_table, read_table

__all__ = ["PARTS", "STANDARD_ATMOSPHERE", "MessageFile", "assemble", "open_messages", "read_recording"]

MAY_BE_EMPTY = ("velocity", "force")
"""Channels that a joint's messages may omit by their definition, without a remark."""


def read_recording(path: str | Path, topics: str | Path | TopicsFile | None = None) -> Recording:
    """Read a recording.

    Args:
        path: an .mcap or .db3 file, a rosbag2 folder, or a table: .csv, .lvm, .mat, .parquet.
        topics: a topics file, or a loaded one; without it channels are found by the contract's names.

    Raises:
        RecordingError: there is nothing usable, or the channels are not clear; the message gives the remedy.
    """
    path = Path(path)
    topics_file = topics_of(topics)
    if not path.exists():
        raise RecordingError(f"{path}: there is no such file or folder")
    if not (path.is_file() or path.is_dir()):
        raise RecordingError(f"{path}: is neither a file nor a folder; name a recording")
    if is_table(path):
        table = read_table(path)
        samples, rules, found = channels_of(path, table, topics_file)
        remarks = [*(topics_file.remarks if topics_file else ()), *found]
        return assemble(path, samples, rules, dict.fromkeys(rules, table.kind), RawRecording(), remarks)
    return _from_messages(path, topics_file)


@dataclass(frozen=True)
class MessageFile:
    """A file or folder of messages with known topics: its channels, and the sinks of their messages."""

    path: Path
    rules: Mapping[str, ChannelRule]
    types: Mapping[str, str]
    sinks: Mapping[str, TopicColumns]
    remarks: tuple[str, ...]
    asked: Collection[str]

    def collect(self) -> tuple[dict[str, Samples], list[str]]:
        """The samples of each channel since the last call, on one clock, and remarks on exclusions."""
        decoded = [sink.finish() for sink in self.sinks.values()]
        remarks = [remark for topic in decoded for remark in topic.remarks]
        decoded, leap_remarks = without_leaps(decoded)
        decoded, clock_remarks = on_one_clock(decoded)
        samples = {name: Samples(topic.stamps, values) for topic in decoded for name, values in topic.columns.items()}
        for name in MAY_BE_EMPTY:
            if name in samples and name not in self.asked and not np.isfinite(samples[name].values).any():
                del samples[name]
        return samples, [*remarks, *leap_remarks, *clock_remarks]


def open_messages(path: Path, topics_file: TopicsFile | None) -> MessageFile:
    """Find the channels of a file or folder of messages.

    Raises:
        RecordingError: as `read_recording`.
    """
    topics = bag_topics(path)
    rules, remarks = find_rules(str(path), topics.keys(), topics_file)
    if leakage := leakage_topic(topics.keys(), rules):
        rules[LEAKAGE_TOPIC] = ChannelRule(leakage, "data")
    sinks = {}
    for topic in dict.fromkeys(str(rule.topic) for rule in rules.values()):
        fields = {name: str(rule.field) for name, rule in rules.items() if rule.topic == topic}
        given = topics_file.channels.keys() & fields.keys() if topics_file else set()
        optional = fields.keys() - given if given else set()
        sinks[topic] = TopicColumns(topics[topic], fields, value_names(path, topics, topic), optional)
    types = {name: topics[str(rule.topic)].type_name for name, rule in rules.items()}
    asked = topics_file.channels.keys() if topics_file is not None else ()
    remarks = (*(topics_file.remarks if topics_file is not None else ()), *remarks)
    return MessageFile(path, rules, types, sinks, remarks, asked)


def _from_messages(path: Path, topics_file: TopicsFile | None) -> Recording:
    file = open_messages(path, topics_file)
    raw = read_bag(path, file.sinks)
    samples, remarks = file.collect()
    return assemble(path, samples, file.rules, file.types, raw, [*file.remarks, *remarks])


def assemble(
    path: Path,
    samples: Mapping[str, Samples],
    rules: Mapping[str, ChannelRule],
    types: Mapping[str, str],
    raw: RawRecording,
    remarks: list[str],
) -> Recording:
    """The samples of each channel as a recording. Raises RecordingError where no channel has a usable sample."""
    return Recording.of(assembled(path, samples, rules, types, raw, remarks))
