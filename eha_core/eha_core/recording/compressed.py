"""Compression that rosbag2 adds to that of MCAP's own chunks: of each message, or of whole files."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO

import numpy as np
from numpy.typing import NDArray
from zstandard import ZstdDecompressor, ZstdError

from eha_core.errors import RecordingError
from eha_core.recording.raw import Sink, Sinks
from eha_core.recording.unpacking import LARGEST_CHUNK, Ceiling

ZSTD = b"\x28\xb5\x2f\xfd"
"""First bytes of a Zstandard frame; a CDR message begins with 0."""
ENDING = ".zstd"
"""Ending of the name of a file that rosbag2 compressed as a whole."""
_PART = 2**20


class _UnpackingSink:
    """Passes messages on, decompressed where necessary."""

    def __init__(self, sink: Sink, ceiling: Ceiling) -> None:
        self._sink, self._ceiling = sink, ceiling
        self._unpacker = ZstdDecompressor(max_window_size=LARGEST_CHUNK)

    def add(self, log_time: int, payload: bytes) -> None:
        self._sink.add(log_time, self._plain(payload))

    def add_block(
        self, content: bytes, starts: NDArray[np.int64], lengths: NDArray[np.int64], log_times: NDArray[np.int64]
    ) -> None:
        first = int(starts[0])
        if content[first : first + len(ZSTD)] != ZSTD:
            self._sink.add_block(content, starts, lengths, log_times)
            return
        for start, length, log_time in zip(starts.tolist(), lengths.tolist(), log_times.tolist(), strict=True):
            self.add(log_time, content[start : start + length])

    def _plain(self, payload: bytes) -> bytes:
        """A message's bytes, decompressed; a damaged one stays as it is, and is counted when it is decoded."""
        if payload[: len(ZSTD)] != ZSTD:
            return payload
        try:
            plain = self._unpacker.decompress(payload, max_output_size=LARGEST_CHUNK)
        except ZstdError:
            return payload
        self._ceiling.take(len(plain))
        return plain


def unpacking(sinks: Sinks, where: str, size: int) -> Mapping[str, Sink]:
    """Sinks that take the messages, compressed or not, of a bag of `size` bytes."""
    ceiling = Ceiling(where, size)
    return {topic: _UnpackingSink(sink, ceiling) for topic, sink in sinks.items()}


def plain_file(path: Path) -> Path:
    """The file itself, or a decompressed copy, which is kept until the process ends.

    Raises:
        RecordingError: it cannot be decompressed, or to more than a file of its size may.
    """
    if path.suffix != ENDING:
        return path
    try:
        status = path.stat()
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from error
    return Path(_unpacked(path, status.st_mtime_ns, status.st_size).name) / path.stem


@lru_cache(maxsize=8)
def _unpacked(path: Path, changed: int, size: int) -> TemporaryDirectory[str]:
    """A folder with the decompressed file; `changed` [ns] distinguishes its versions."""
    folder = TemporaryDirectory(prefix="eha-")
    ceiling = Ceiling(str(path), size)
    try:
        with path.open("rb") as packed, (Path(folder.name) / path.stem).open("wb") as plain:
            _unpack(packed, plain, ceiling)
    except (OSError, ZstdError, RecordingError) as error:
        folder.cleanup()
        if isinstance(error, RecordingError):
            raise
        raise RecordingError(f"{path}: cannot be unpacked ({error}); copy it anew") from error
    return folder


def _unpack(packed: IO[bytes], plain: IO[bytes], ceiling: Ceiling) -> None:
    with ZstdDecompressor(max_window_size=LARGEST_CHUNK).stream_reader(packed, read_across_frames=True) as reader:
        while part := reader.read(_PART):
            ceiling.take(len(part))
            plain.write(part)
