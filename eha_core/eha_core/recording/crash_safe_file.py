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

    Bytes are held until `flush`, which puts them where the former closing records stood, followed by closing records
    anew, in one system call. So at every instant the file on disk is a whole MCAP of what was flushed.
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
        """Where the next byte goes [bytes from the start]."""
        return self._flushed + len(self._pending)

    def flush(self) -> None:
        """Put everything held on disk.

        Raises OSError (a full disk, a file that was removed); the file then holds what was flushed before.
        """
        if os.fstat(self._descriptor).st_nlink == 0:
            raise OSError(errno.ENOENT, "the file was removed")
        if self._pending:
            self._put(self._ending)

    def close(self) -> None:
        """Put what is held on disk, which brings the file's own ending, and close."""
        try:
            self._put(b"")
            os.ftruncate(self._descriptor, self._flushed)
        finally:
            os.close(self._descriptor)

    def discard(self) -> None:
        """Close the file as it was flushed last."""
        os.close(self._descriptor)

    def _put(self, ending: bytes) -> None:
        data = bytes(self._pending) + ending
        written = 0
        try:
            while written < len(data):
                written += os.pwrite(self._descriptor, data[written:], self._flushed + written)
        except OSError:
            # A full disk may have taken a part: cut it off, the closing records fit where they stood before.
            os.ftruncate(self._descriptor, self._flushed)
            os.pwrite(self._descriptor, self._ending, self._flushed)
            raise
        self._flushed += len(self._pending)
        self._pending.clear()
