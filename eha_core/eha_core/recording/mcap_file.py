"""Reads MCAP files from front to back, so that what is sound in a damaged file is saved."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import IO

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.records import Channel, Chunk, Footer, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.summary import Summary
from mcap.writer import MCAP0_MAGIC
from zstandard import ZstdDecompressor, ZstdError

from eha_core.errors import RecordingError
from eha_core.recording.raw import RawRecording, RawTopic, TopicFilter

# What parsing of arbitrary bytes raises: ends too early, bad lengths and text, checksums, broken compression.
_UNREADABLE = (McapError, ZstdError, struct.error, ValueError, RuntimeError, MemoryError, OverflowError, LookupError)
_LARGEST_CHUNK = 2**30
_RECORD_HEAD = struct.Struct("<BQ")  # kind, length
_CHECKSUM_SIZE = 4
_FOOTER_SIZE = _RECORD_HEAD.size + 8 + 8 + _CHECKSUM_SIZE + len(MCAP0_MAGIC)


class _Collector:
    """Sorts records into topics."""

    def __init__(self, wanted: TopicFilter) -> None:
        self.recording = RawRecording()
        self.bad_chunks = 0
        self.lost_messages = 0
        self._wanted = wanted
        self._schemas: dict[int, Schema] = {}
        self._topics: dict[int, RawTopic | None] = {}

    def add(self, record: McapRecord) -> None:
        if isinstance(record, Message):
            if record.channel_id not in self._topics:
                self.lost_messages += 1
            elif topic := self._topics[record.channel_id]:
                topic.log_times.append(record.log_time)
                topic.payloads.append(record.data)
        elif isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._add_channel(record)
        elif isinstance(record, Metadata):
            self.recording.metadata.setdefault(record.name, {}).update(record.metadata)

    def _add_channel(self, channel: Channel) -> None:
        schema = self._schemas.get(channel.schema_id)
        type_name = schema.name if schema else ""
        definition = schema.data.decode("utf-8", errors="replace") if schema else ""
        topic = RawTopic(channel.topic, type_name, schema.encoding if schema else "", definition)
        topic = self.recording.topics.setdefault(channel.topic, topic)
        self._topics[channel.id] = topic if channel.message_encoding == "cdr" and self._wanted(channel.topic) else None


def read_mcap(path: Path, wanted: TopicFilter) -> RawRecording:
    """Read the topics that `wanted` accepts.

    Chunks with a wrong checksum are left out, and after broken structure reading goes on at the next chunk that the
    summary knows; `damage` of the result then says what was lost.

    Raises:
        RecordingError: the file cannot be opened or is no MCAP.
    """
    try:
        with path.open("rb") as stream:
            magic = stream.read(len(MCAP0_MAGIC))
            if not magic:
                raise RecordingError(f"{path}: the file is empty; record again")
            if magic != MCAP0_MAGIC:
                raise RecordingError(f"{path}: not an MCAP file (it starts with other bytes)")
            return _read_records(stream, path.stat().st_size, wanted)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from error


def _read_records(stream: IO[bytes], size: int, wanted: TopicFilter) -> RawRecording:
    collector = _Collector(wanted)
    summary = _summary(stream, size)
    chunk_starts = sorted(index.chunk_start_offset for index in summary.chunk_indexes) if summary else []
    for record in (*summary.schemas.values(), *summary.channels.values()) if summary else ():
        collector.add(record)
    damage = collector.recording.damage
    # A damaged length is only believed up to the next chunk that the summary knows.
    starts = [len(MCAP0_MAGIC), *chunk_starts]
    for start, end in zip(starts, [*chunk_starts, size], strict=True):
        broken_at = _collect(stream, start, end, end == size, collector)
        if broken_at == size:
            damage.append("its end is missing")
        elif broken_at is not None:
            if end == size:
                _add_cut_chunk(stream, broken_at, collector)
            damage.append(f"{end - broken_at} bytes from byte {broken_at} of {size} could not be read")
    if collector.bad_chunks:
        damage.append(f"damaged chunks left out: {collector.bad_chunks}")
    if collector.lost_messages:
        damage.append(f"messages left out for want of their topic's description: {collector.lost_messages}")
    return collector.recording


def _collect(stream: IO[bytes], start: int, end: int, is_last: bool, collector: _Collector) -> int | None:
    """Collect the records from byte `start` to byte `end`; return where their structure breaks, if it does."""
    position = start
    for record, after in _records(stream, start, end):
        if after > end:
            return position
        position = after
        if isinstance(record, Chunk):
            _add_chunk(record, collector)
        elif isinstance(record, Footer):
            stream.seek(position)
            return None if stream.read() == MCAP0_MAGIC else position
        else:
            collector.add(record)
        if position == end and not is_last:
            return None
    return position


def _records(stream: IO[bytes], start: int, end: int) -> Iterator[tuple[McapRecord, int]]:
    """The records from byte `start` on, each with the byte after it, up to the first that is unreadable."""
    stream.seek(start)
    reader = StreamReader(stream, skip_magic=True, emit_chunks=True, record_size_limit=end - start)
    records = iter(reader.records)
    while True:
        try:
            record = next(records)
        except (*_UNREADABLE, StopIteration):
            return
        yield record, stream.tell()


def _add_chunk(chunk: Chunk, collector: _Collector) -> None:
    """Hand all records of a chunk to the collector, or none and count it if it is damaged."""
    try:
        if chunk.uncompressed_size > _LARGEST_CHUNK:
            raise ValueError("a chunk of that size is a damaged length")
        records = breakup_chunk(chunk, validate_crc=True)
    except _UNREADABLE:
        collector.bad_chunks += 1
        return
    for record in records:
        collector.add(record)


def _add_cut_chunk(stream: IO[bytes], start: int, collector: _Collector) -> None:
    """Hand on the whole records at the beginning of a chunk that the file's end cuts off, if one starts there."""
    stream.seek(start)
    data = stream.read()
    try:
        if data[0] != Opcode.CHUNK:
            return
        chunk = Chunk.read(ReadDataStream(BytesIO(data[_RECORD_HEAD.size :])))
        content = (
            ZstdDecompressor().decompressobj().decompress(chunk.data) if chunk.compression == "zstd" else chunk.data
        )
        if chunk.compression not in ("", "zstd") or len(content) >= chunk.uncompressed_size:
            return
    except _UNREADABLE:
        return
    end = 0
    while end + _RECORD_HEAD.size <= len(content):
        after = end + _RECORD_HEAD.size + _RECORD_HEAD.unpack_from(content, end)[1]
        if after > len(content):
            break
        end = after
    for record, _ in _records(BytesIO(content[:end]), 0, end):
        collector.add(record)


def _summary(stream: IO[bytes], size: int) -> Summary | None:
    """The summary; None where the file has none or its checksum is wrong."""
    try:
        stream.seek(size - _FOOTER_SIZE)
        footer = next(iter(StreamReader(stream, skip_magic=True).records))
        if not isinstance(footer, Footer) or not 0 < footer.summary_start < size:
            return None
        stream.seek(footer.summary_start)
        checked = stream.read(size - len(MCAP0_MAGIC) - _CHECKSUM_SIZE - footer.summary_start)
        if footer.summary_crc not in (0, zlib.crc32(checked)):
            return None
        stream.seek(0)
        return make_reader(stream).get_summary()
    except (*_UNREADABLE, OSError):
        return None
