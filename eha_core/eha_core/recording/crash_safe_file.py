"""A file that is a complete MCAP after every flush, so that a killed writer leaves one that any reader opens."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

from mcap.data_stream import RecordBuilder
from mcap.records import DataEnd, Footer
from mcap.writer import MCAP0_MAGIC


def _closing_records() -> bytes:
    """The shortest legal end of an MCAP: no summary, so readers scan the chunks."""
    builder: Any = RecordBuilder()
    DataEnd(data_section_crc=0).write(builder)
    Footer(summary_start=0, summary_offset_start=0, summary_crc=0).write(builder)
    return bytes(builder.end()) + MCAP0_MAGIC


class CrashSafeFile:
    """The part of a binary stream that the MCAP writer uses: write, tell, flush, close.

    Bytes are held until `flush`, which writes them over the former closing records, followed by new ones, in one system
    call. So the file on disk is always a complete MCAP of the flushed data.
    """

    def __init__(self, path: Path) -> None:
        self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_CLOEXEC", 0), 0o644)
        self._flushed = 0
        self._pending = bytearray()
        self._ending = _closing_records()

    def write(self, data: bytes) -> int:
        """Hold `data` until the next flush."""
        self._pending += data
        return len(data)

    def tell(self) -> int:
        """Position of the next byte [bytes from the start]."""
        return self._flushed + len(self._pending)

    def flush(self) -> None:
        """Write all held bytes to disk.

        Raises OSError (a full disk, a file that was removed); the file then has the data of earlier flushes.
        """
        if os.fstat(self._descriptor).st_nlink == 0:
            raise OSError(errno.ENOENT, "the file was removed")
        if self._pending:
            self._put(self._ending)

    def close(self) -> None:
        """Write the held bytes, which include the file's own ending, to disk, and close."""
        try:
            self._put(b"")
            os.ftruncate(self._descriptor, self._flushed)
        finally:
            os.close(self._descriptor)

    def discard(self) -> None:
        """Close the file as of its last flush."""
        os.close(self._descriptor)

    def _put(self, ending: bytes) -> None:
        data = bytes(self._pending) + ending
        written = 0
        try:
            while written < len(data):
                written += os.pwrite(self._descriptor, data[written:], self._flushed + written)
        except OSError:
            # A full disk may have taken a part: cut it off; the closing records fit in their former place.
            os.ftruncate(self._descriptor, self._flushed)
            os.pwrite(self._descriptor, self._ending, self._flushed)
            raise
        self._flushed += len(self._pending)
        self._pending.clear()
