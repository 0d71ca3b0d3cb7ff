"""Reads MCAP files from front to back, so that the sound parts of a damaged file are recovered."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import IO, Any

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Footer, McapRecord, Message, Metadata, Schema
from mcap.writer import MCAP0_MAGIC

from eha_core.recording.mcap_summary import RECORD_HEAD, UNREADABLE, opened, summary_of
from eha_core.recording.raw import RawRecording, RawTopic, Sink, Sinks
from eha_core.recording.unpacking import LARGEST_CHUNK, Ceiling, unpacked, unpacked_start

_MESSAGE_HEAD = struct.Struct("<BQHIQQ")  # kind, length, channel, sequence, log time, publish time
_KINDS: dict[int, Any] = {
    Opcode.FOOTER: Footer, Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel, Opcode.MESSAGE: Message,
    Opcode.CHUNK: Chunk, Opcode.METADATA: Metadata,
}  # fmt: skip
"""The records that are read; others are skipped."""


class _Collector:
    """Sorts records into topics, and passes messages to the topics' sinks."""

    def __init__(self, sinks: Sinks, ceiling: Ceiling) -> None:
        self.recording = RawRecording()
        self.ceiling = ceiling
        self.message_count = 0
        self.bad_chunks = 0
        self.lost_messages = 0
        self._sinks = sinks
        self._schemas: dict[int, Schema] = {}
        self._topics: dict[int, tuple[str, Sink | None]] = {}

    def add(self, record: McapRecord) -> None:
        if isinstance(record, Message):
            if sink := self._count(record.channel_id, 1):
                sink.add(record.log_time, record.data)
        elif isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._add_channel(record)
        elif isinstance(record, Metadata):
            self.recording.metadata.setdefault(record.name, {}).update(record.metadata)

    def add_content(self, content: bytes, is_cut: bool = False) -> None:
        """Take all records of a chunk, or none if one is damaged; of a chunk without an end, the complete ones.

        Raises one of UNREADABLE for a damaged chunk.
        """
        found = _walk(content, is_cut)
        for record in found.others:
            self.add(record)
        for channel, (starts, ends, log_times) in found.messages.items():
            if sink := self._count(channel, len(starts)):
                first = np.array(starts, dtype=np.int64)
                logged = np.array(log_times, dtype=np.uint64).astype(np.int64)
                sink.add_block(content, first, np.array(ends, dtype=np.int64) - first, logged)

    def _count(self, channel: int, count: int) -> Sink | None:
        """Count messages of a channel, and return the sink for them; None without one."""
        self.message_count += count
        if channel not in self._topics:
            self.lost_messages += count
            return None
        topic, sink = self._topics[channel]
        self.recording.counts[topic] = self.recording.counts.get(topic, 0) + count
        return sink

    def _add_channel(self, channel: Channel) -> None:
        schema = self._schemas.get(channel.schema_id)
        type_name = schema.name if schema else ""
        definition = schema.data.decode("utf-8", errors="replace") if schema else ""
        topic = RawTopic(channel.topic, type_name, schema.encoding if schema else "", definition)
        self.recording.topics.setdefault(channel.topic, topic)
        sink = self._sinks.get(channel.topic) if channel.message_encoding == "cdr" else None
        self._topics[channel.id] = (channel.topic, sink)


@dataclass
class _Found:
    """The records of a chunk: the places and log times of each channel's messages, and the other records."""

    messages: dict[int, tuple[list[int], list[int], list[int]]]
    others: list[McapRecord]


def _walk(content: bytes, is_cut: bool) -> _Found:
    found = _Found({}, [])
    position, size = 0, len(content)
    unpack, head = _MESSAGE_HEAD.unpack_from, _MESSAGE_HEAD.size
    while position < size:
        if content[position] == Opcode.MESSAGE and position + head <= size:
            _, length, channel, _, log_time, _ = unpack(content, position)
            start, position = position + head, position + RECORD_HEAD.size + length
            if not start <= position <= size:
                break
            rows = found.messages.get(channel)
            if rows is None:
                rows = found.messages[channel] = ([], [], [])
            rows[0].append(start)
            rows[1].append(position)
            rows[2].append(log_time)
            continue
        record, position = next(_records(BytesIO(content), position, size), (None, size + 1))
        if record is not None:
            found.others.append(record)
    if position != size and not is_cut:
        raise ValueError("its records do not fill the chunk")
    return found


def mcap_topics(path: Path) -> dict[str, RawTopic]:
    """The topics of a file by name: from its summary, or without one from the whole file.

    Raises:
        RecordingError: as `read_mcap`.
    """
    with opened(path) as (stream, size):
        summary = summary_of(stream, size)
        collector = _Collector({}, Ceiling(str(path), size))
        if summary is None:
            return _read_records(stream, size, collector).topics
        for record in (*summary.schemas.values(), *summary.channels.values()):
            collector.add(record)
        return collector.recording.topics


def read_mcap(path: Path, sinks: Sinks) -> RawRecording:
    """Read the messages of the topics that `sinks` names.

    Chunks with a wrong checksum are skipped, and after a broken structure reading continues at the next chunk that the
    summary lists; `damage` of the result lists what was lost.

    Raises:
        RecordingError: the file cannot be opened, is not an MCAP, or decompresses to more than its size allows.
    """
    with opened(path) as (stream, size):
        return _read_records(stream, size, _Collector(sinks, Ceiling(str(path), size)))


def _read_records(stream: IO[bytes], size: int, collector: _Collector) -> RawRecording:
    summary = summary_of(stream, size)
    chunk_starts = sorted(index.chunk_start_offset for index in summary.chunk_indexes) if summary else []
    for record in (*summary.schemas.values(), *summary.channels.values()) if summary else ():
        collector.add(record)
    damage = collector.recording.damage
    # A damaged length counts only up to the next chunk that the summary lists.
    starts = [len(MCAP0_MAGIC), *chunk_starts]
    for start, end in zip(starts, [*chunk_starts, size], strict=True):
        broken_at = _collect(stream, start, end, end == size, collector)
        if broken_at == size:
            damage.append("its end is missing")
        elif broken_at is not None:
            if end == size and _add_cut_chunk(stream, broken_at, collector):
                damage.append(f"its end is missing, from within the chunk at byte {broken_at} of {size} on")
            else:
                damage.append(f"{end - broken_at} bytes from byte {broken_at} of {size} could not be read")
    if collector.bad_chunks:
        damage.append(f"damaged chunks left out: {collector.bad_chunks}")
    if collector.lost_messages:
        damage.append(f"messages left out for want of their topic's description: {collector.lost_messages}")
    promised = summary.statistics.message_count if summary and summary.statistics else 0
    if promised > collector.message_count:
        damage.append(f"{promised - collector.message_count} of {promised} messages are missing")
    if summary is None and not damage:
        damage.append("it was not finished: what its recorder had not put on disk yet is missing")
    return collector.recording


def _collect(stream: IO[bytes], start: int, end: int, is_last: bool, collector: _Collector) -> int | None:
    """Collect the records from byte `start` to byte `end`; return the byte at which their structure breaks, if any."""
    position = start
    for record, after in _records(stream, start, end):
        position = after
        if isinstance(record, Chunk):
            _add_chunk(record, collector)
        elif isinstance(record, Footer):
            stream.seek(position)
            return None if stream.read() == MCAP0_MAGIC else position
        elif record:
            collector.add(record)
        if position == end and not is_last:
            return None
    return position


def _records(stream: IO[bytes], start: int, end: int) -> Iterator[tuple[McapRecord | None, int]]:
    """The records from byte `start` to byte `end`, each with the byte after it, up to the first that is unreadable.

    Kinds that do not matter are None.
    """
    position = start
    while True:
        stream.seek(position)
        head = stream.read(RECORD_HEAD.size)
        if len(head) < RECORD_HEAD.size:
            return
        kind, length = RECORD_HEAD.unpack(head)
        position += RECORD_HEAD.size + length
        if kind == 0 or position > end:  # no record has kind 0, but zeroed bytes look like it
            return
        try:
            yield (_parse(kind, stream.read(length)) if kind in _KINDS else None), position
        except UNREADABLE:
            return


def _parse(kind: int, content: bytes) -> McapRecord:
    data = ReadDataStream(BytesIO(content))
    record: McapRecord = Message.read(data, len(content)) if kind == Opcode.MESSAGE else _KINDS[kind].read(data)
    return record


def _add_chunk(chunk: Chunk, collector: _Collector) -> None:
    """Pass all records of a chunk to the collector; of a damaged one none, and count it."""
    try:
        content = unpacked(chunk, collector.ceiling)
        if chunk.uncompressed_crc not in (0, zlib.crc32(content)):
            raise ValueError("the chunk has another checksum")
        collector.add_content(content)
    except UNREADABLE:
        collector.bad_chunks += 1


def _add_cut_chunk(stream: IO[bytes], start: int, collector: _Collector) -> bool:
    """Pass on the complete records of a chunk that the file's end cuts off; False if there are none."""
    stream.seek(start)
    data = stream.read()
    try:
        if data[0] != Opcode.CHUNK:
            return False
        chunk = Chunk.read(ReadDataStream(BytesIO(data[RECORD_HEAD.size :])))
        content = unpacked_start(chunk, LARGEST_CHUNK)
    except UNREADABLE:
        return False
    if not 0 < len(content) < chunk.uncompressed_size:
        return False
    collector.ceiling.take(len(content))
    collector.add_content(content, is_cut=True)
    return True
