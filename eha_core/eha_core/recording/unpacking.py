"""Unpacks compressed chunks within a ceiling, so that a small file cannot take the machine's memory."""

from __future__ import annotations

from io import BytesIO

import lz4.frame
from mcap.records import Chunk
from zstandard import ZstdDecompressor, ZstdError

from eha_core.errors import RecordingError

LARGEST_CHUNK = 2**26
"""Bytes that a chunk may unpack to; rosbag2 writes chunks of 0.8 MB, other recorders of up to 16 MB."""
ROOM = 2**25
"""Bytes that any file may unpack to ..."""
LARGEST_RATIO = 100
"""... and bytes for each byte of a larger one: a rig at rest, every sample the same, packs to 1/20."""


class Ceiling:
    """Counts what a file has unpacked to against what a file of its size may."""

    def __init__(self, where: str, size: int) -> None:
        self._where = where
        self._most = self._left = ROOM + LARGEST_RATIO * size

    def take(self, count: int) -> None:
        """Count so many bytes. Raises RecordingError where they are too many."""
        self._left -= count
        if self._left < 0:
            raise RecordingError(
                f"{self._where}: unpacks to more than {self._most / 1e6:.0f} MB, as no recording of its size does;"
                " record or convert it anew"
            )


def unpacked(chunk: Chunk, ceiling: Ceiling) -> bytes:
    """The records of a chunk, uncompressed.

    Raises:
        ValueError: it does not unpack to the size that it says, or to too large a one for a chunk.
        RecordingError: the file passes its ceiling.
    """
    if chunk.uncompressed_size > LARGEST_CHUNK:
        raise ValueError("a chunk of that size is a damaged length")
    ceiling.take(chunk.uncompressed_size)
    content = unpacked_start(chunk, chunk.uncompressed_size + 1)
    if len(content) != chunk.uncompressed_size:
        raise ValueError("the chunk has another size than it says")
    return content


def unpacked_start(chunk: Chunk, most: int) -> bytes:
    """Up to `most` bytes of a chunk's records, also where its end is missing. Raises ValueError for other packing."""
    if chunk.compression == "":
        return bytes(chunk.data[:most])
    if chunk.compression == "zstd":
        return _unzstd(chunk.data, most)
    if chunk.compression == "lz4":
        return bytes(lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=most))
    raise ValueError(f"compression {chunk.compression!r} is not known")


def _unzstd(data: bytes, most: int) -> bytes:
    """What a Zstandard frame gives before it ends, is full, or breaks."""
    content = bytearray()
    with ZstdDecompressor(max_window_size=LARGEST_CHUNK).stream_reader(BytesIO(data)) as reader:
        try:
            while len(content) < most and (part := reader.read(min(most - len(content), 2**18))):
                content += part
        except ZstdError:
            pass  # the sum over the chunk tells whether what came before is whole
    return bytes(content)
