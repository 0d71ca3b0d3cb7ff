"""The summary at the end of an MCAP file: whether it was finished, its time span, its metadata."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Footer
from mcap.stream_reader import StreamReader
from mcap.summary import Summary
from mcap.writer import MCAP0_MAGIC
from zstandard import ZstdError

from eha_core.errors import RecordingError

# Errors of parsing arbitrary bytes: early ends, bad lengths and text, checksums, broken compression.
UNREADABLE = (McapError, ZstdError, struct.error, ValueError, RuntimeError, MemoryError, OverflowError, LookupError)
RECORD_HEAD = struct.Struct("<BQ")  # kind, length
_CHECKSUM_SIZE = 4
_FOOTER_SIZE = RECORD_HEAD.size + 8 + 8 + _CHECKSUM_SIZE + len(MCAP0_MAGIC)


@contextmanager
def opened(path: Path) -> Iterator[tuple[IO[bytes], int]]:
    try:
        with path.open("rb") as stream:
            magic = stream.read(len(MCAP0_MAGIC))
            if not magic:
                raise RecordingError(f"{path}: the file is empty; record again")
            if magic != MCAP0_MAGIC:
                raise RecordingError(f"{path}: not an MCAP file (it starts with other bytes)")
            yield stream, path.stat().st_size
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from error


def is_finished(path: Path) -> bool:
    """Whether an MCAP has the footer that its recorder writes when it stops. Raises OSError where it is unreadable."""
    with path.open("rb") as stream:
        return summary_of(stream, path.stat().st_size) is not None


def mcap_extent(path: Path) -> tuple[int, int] | None:
    """The log times of the first and last message [ns]; None where the file has no summary with them."""
    with opened(path) as (stream, size):
        summary = summary_of(stream, size)
        statistics = summary.statistics if summary else None
        if not statistics or not statistics.message_count:
            return None
        return statistics.message_start_time, statistics.message_end_time


def mcap_metadata(path: Path) -> dict[str, dict[str, str]]:
    """The metadata records that the summary lists, by name, without reading the messages."""
    with opened(path) as (stream, size):
        found: dict[str, dict[str, str]] = {}
        if summary_of(stream, size) is None:
            return found
        try:
            for record in make_reader(stream).iter_metadata():
                found.setdefault(record.name, {}).update(record.metadata)
        except (*UNREADABLE, OSError):
            return found
        return found


def summary_of(stream: IO[bytes], size: int) -> Summary | None:
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
    except (*UNREADABLE, OSError):
        return None
