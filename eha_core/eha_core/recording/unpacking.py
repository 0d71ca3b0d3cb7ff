"""Decompresses chunks within a limit, so that a small file cannot exhaust the machine's memory."""

from __future__ import annotations

from io import BytesIO

import lz4.frame
from mcap.records import Chunk
from zstandard import ZstdDecompressor, ZstdError

from eha_core.errors import RecordingError

LARGEST_CHUNK = 2**26
"""Most bytes of a decompressed chunk; rosbag2 writes chunks of 0.8 MB, other recorders of up to 16 MB."""
ROOM = 2**25
"""Bytes that any file may decompress to ..."""
LARGEST_RATIO = 100
"""... and bytes for each byte of a larger one: a rig at rest, every sample the same, compresses to 1/20."""


class Ceiling:
    """Counts the decompressed bytes of a file against the limit for its size."""

    def __init__(self, where: str, size: int) -> None:
        self._where = where
        self._most = self._left = ROOM + LARGEST_RATIO * size

    def take(self, count: int) -> None:
        """Count bytes. Raises RecordingError where they exceed the limit."""
        self._left -= count
        if self._left < 0:
            raise RecordingError(
                f"{self._where}: unpacks to more than {self._most / 1e6:.0f} MB, as no recording of its size does;"
                " record or convert it anew"
            )


def unpacked(chunk: Chunk, ceiling: Ceiling) -> bytes:
    """The decompressed records of a chunk.

    Raises:
        ValueError: its decompressed size is not the stated one, or too large for a chunk.
        RecordingError: the file exceeds its limit.
    """
    if chunk.uncompressed_size > LARGEST_CHUNK:
        raise ValueError("a chunk of that size is a damaged length")
    ceiling.take(chunk.uncompressed_size)
    content = unpacked_start(chunk, chunk.uncompressed_size + 1)
    if len(content) != chunk.uncompressed_size:
        raise ValueError("the chunk has another size than it says")
    return content


def unpacked_start(chunk: Chunk, most: int) -> bytes:
    """Up to `most` bytes of a chunk's records, also where its end is missing. Raises ValueError for an unknown
    compression."""
    if chunk.compression == "":
        return bytes(chunk.data[:most])
    if chunk.compression == "zstd":
        return _unzstd(chunk.data, most)
    if chunk.compression == "lz4":
        return bytes(lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=most))
    raise ValueError(f"compression {chunk.compression!r} is not known")


def _unzstd(data: bytes, most: int) -> bytes:
    """The content of a Zstandard frame up to `most` bytes or a damaged place."""
    content = bytearray()
    with ZstdDecompressor(max_window_size=LARGEST_CHUNK).stream_reader(BytesIO(data)) as reader:
        try:
            while len(content) < most and (part := reader.read(min(most - len(content), 2**18))):
                content += part
        except ZstdError:
            pass  # the chunk's checksum shows whether the part before is complete
    return bytes(content)
