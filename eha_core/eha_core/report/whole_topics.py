"""Writes complete topics as one MCAP with the profile `ros2`; the messages are serialised as arrays, not one by one.

`RecordingWriter` writes messages as they arrive, so that a killed process loses little; here all are known beforehand.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.writer import LIBRARY_IDENTIFIER, MCAP0_MAGIC
from numpy.typing import NDArray

from eha_core.errors import RecordingError
from eha_core.identification.numbers import Integers
from eha_core.recording import PARAMETERS_RECORD, OfferedQuality, definition_of

CHUNK = 1 << 20
"""Bytes of a chunk before compression, as the mcap library has them."""

_HEAD = np.dtype(
    [("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"), ("publish", "<u8")]
)
"""The fields before a message's data."""

_COUNTED = 9  # bytes of a record's opcode and length, which its length leaves out


@dataclass(frozen=True)
class Topic:
    """All messages of one topic.

    Attributes:
        stamps: log times [ns], ascending, shape (n,).
        data: one serialised message for each stamp, all of one length.
    """

    name: str
    type_name: str
    stamps: Integers
    data: Sequence[bytes]


@dataclass(frozen=True)
class _Messages:
    """The messages of all topics in the order of their stamps.

    Attributes:
        data: the bytes of all records, one after the other.
        starts: where each record begins in them; the last entry is their end, shape (n + 1,).
        stamps, channels: of each record, shape (n,).
    """

    data: NDArray[np.uint8]
    starts: Integers
    stamps: Integers
    channels: Integers


def write_topics(path: Path, topics: Sequence[Topic], parameters: Mapping[str, object]) -> int:
    """Write the topics to a new file, with `parameters` as a metadata record; return the number of messages.

    Raises:
        RecordingError: the file exists already or cannot be written.
    """
    topics = [topic for topic in topics if len(topic.stamps)]
    messages = _in_order(topics)
    file: Any = RecordBuilder()
    file.write(MCAP0_MAGIC)
    Header("ros2", LIBRARY_IDENTIFIER).write(file)
    metadata_start = file.count
    Metadata(PARAMETERS_RECORD, {name: str(value) for name, value in parameters.items()}).write(file)
    metadata = MetadataIndex(metadata_start, file.count - metadata_start, PARAMETERS_RECORD)
    schemas, channels = _declarations(topics)
    # the declarations stand in the first chunk, before any message
    declared = _bytes_of([*schemas, *channels])
    indices = []
    for first, last in pairwise(_chunk_edges(messages.starts)):
        indices.append(_write_chunk(file, messages, slice(first, last), declared))
        declared = b""
    DataEnd(0).write(file)
    _write_summary(file, [schemas, channels, [_statistics(topics, schemas, messages, indices)], indices, [metadata]])
    if path.exists():
        raise RecordingError(f"{path}: exists already; choose another name or remove it")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("xb") as stream:
            stream.write(file.end())
    except OSError as error:
        raise RecordingError(f"{path}: cannot be written ({error.strerror}: {error.filename})") from error
    return len(messages.stamps)


def _in_order(topics: Sequence[Topic]) -> _Messages:
    records = [_records(number, topic) for number, topic in enumerate(topics, start=1)]
    counts, widths = [len(one) for one in records], [one.shape[1] if len(one) else 0 for one in records]
    stamps = np.concatenate([np.empty(0, np.int64), *(topic.stamps for topic in topics)])
    order = np.argsort(stamps, kind="stable")
    sizes = np.repeat(np.array(widths, dtype=np.int64), counts)[order]
    starts = np.concatenate([[0], np.cumsum(sizes)])
    places = np.empty(len(order), np.int64)
    places[order] = starts[:-1]
    data = np.empty(starts[-1], np.uint8)
    for one, at in zip(records, np.split(places, np.cumsum(counts)[:-1]), strict=False):
        data[at[:, None] + np.arange(one.shape[1])] = one
    channels = np.repeat(np.arange(1, len(topics) + 1), counts)
    return _Messages(data, starts, stamps[order], channels[order])


def _records(channel: int, topic: Topic) -> NDArray[np.uint8]:
    """The topic's messages as records, one a row."""
    count = len(topic.stamps)
    data = np.frombuffer(b"".join(topic.data), np.uint8).reshape(count, -1)
    head = np.zeros(count, _HEAD)
    head["opcode"], head["channel"] = Opcode.MESSAGE, channel
    head["length"] = _HEAD.itemsize - _COUNTED + data.shape[1]
    head["log"] = head["publish"] = topic.stamps
    return np.hstack([head.view(np.uint8).reshape(count, -1), data])


def _declarations(topics: Sequence[Topic]) -> tuple[list[Any], list[Any]]:
    """A schema for each type, and a channel for each topic."""
    numbers: dict[str, int] = {}
    schemas, channels = [], []
    for channel, topic in enumerate(topics, start=1):
        definition, type_hash = definition_of(topic.type_name)
        if topic.type_name not in numbers:
            numbers[topic.type_name] = len(numbers) + 1
            schemas.append(Schema(numbers[topic.type_name], definition.encode(), "ros2msg", topic.type_name))
        offered = {"offered_qos_profiles": OfferedQuality().as_yaml(), "topic_type_hash": type_hash}
        channels.append(Channel(channel, topic.name, "cdr", offered, numbers[topic.type_name]))
    return schemas, channels


def _bytes_of(records: Sequence[Any]) -> bytes:
    builder: Any = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())


def _chunk_edges(starts: Integers) -> list[int]:
    """The first message of each chunk, and the number of messages."""
    count = len(starts) - 1
    first = np.flatnonzero(np.diff(starts[:-1] // CHUNK, prepend=-1)) if count else np.empty(0, np.int64)
    return [*first.tolist(), count]


def _write_chunk(file: Any, messages: _Messages, rows: slice, declared: bytes) -> ChunkIndex:
    """Write `declared` and the messages of these rows, compressed, and the index of each channel."""
    stamps, channels = messages.stamps[rows], messages.channels[rows]
    starts = messages.starts[rows.start : rows.stop + 1]
    data = declared + messages.data[starts[0] : starts[-1]].tobytes()
    packed = zstandard.compress(data)
    chunk = Chunk(
        compression="zstd",
        data=packed,
        message_start_time=int(stamps[0]),
        message_end_time=int(stamps[-1]),
        uncompressed_crc=zlib.crc32(data),
        uncompressed_size=len(data),
    )
    begin = file.count
    chunk.write(file)
    end = file.count
    offsets = {}
    pairs = np.column_stack([stamps, starts[:-1] - starts[0] + len(declared)]).astype("<u8")
    for channel in np.unique(channels).tolist():
        offsets[channel] = file.count
        entries = pairs[channels == channel].tobytes()
        file.start_record(Opcode.MESSAGE_INDEX)
        file.write2(channel)
        file.write4(len(entries))
        file.write(entries)
        file.finish_record()
    return ChunkIndex(
        chunk_start_offset=begin,
        chunk_length=end - begin,
        message_index_offsets=offsets,
        message_index_length=file.count - end,
        compression=chunk.compression,
        compressed_size=len(packed),
        message_start_time=chunk.message_start_time,
        message_end_time=chunk.message_end_time,
        uncompressed_size=chunk.uncompressed_size,
    )


def _statistics(
    topics: Sequence[Topic], schemas: Sequence[Any], messages: _Messages, indices: Sequence[ChunkIndex]
) -> Statistics:
    return Statistics(
        attachment_count=0,
        channel_count=len(topics),
        channel_message_counts={number: len(topic.stamps) for number, topic in enumerate(topics, start=1)},
        chunk_count=len(indices),
        message_count=len(messages.stamps),
        message_start_time=int(messages.stamps[0]) if len(messages.stamps) else 0,
        message_end_time=int(messages.stamps[-1]) if len(messages.stamps) else 0,
        metadata_count=1,
        schema_count=len(schemas),
    )


_GROUPS = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.STATISTICS, Opcode.CHUNK_INDEX, Opcode.METADATA_INDEX)


def _write_summary(file: Any, groups: Sequence[Sequence[Any]]) -> None:
    """Write the summary section: the records of `_GROUPS`, the offset of each group, and the footer."""
    begin = file.count
    summary: Any = RecordBuilder()
    offsets = []
    for opcode, records in zip(_GROUPS, groups, strict=True):
        start = summary.count
        for record in records:
            record.write(summary)
        offsets.append(SummaryOffset(opcode, begin + start, summary.count - start))
    offsets_begin = begin + summary.count
    for offset in offsets:
        offset.write(summary)
    data = summary.end()
    footer: Any = RecordBuilder()
    Footer(begin, offsets_begin, 0).write(footer)
    end = footer.end()[:-4]  # the checksum covers the footer but for itself
    file.write(data)
    Footer(begin, offsets_begin, zlib.crc32(end, zlib.crc32(data))).write(file)
    file.write(MCAP0_MAGIC)
