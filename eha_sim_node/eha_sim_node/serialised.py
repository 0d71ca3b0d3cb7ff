"""Messages that are sent again and again with another stamp and other numbers: serialised once, then written in place.

To set two dozen fields of a message and to serialise them costs a period of the simulator more than its plant does.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from rclpy.serialization import serialize_message

from eha_core.realtime import NANOSECONDS

_SECONDS, _NANOSECONDS = 0x5A17C3E9, 0x2B6D94F1  # a stamp that occurs nowhere else in a message, to find its place by


class Serialised:
    """A message's bytes, of which the stamp and some float64 change.

    Args:
        message: as it is sent, but for what changes.
        stamp: its builtin_interfaces/msg/Time.
        put: writes the numbers into the message; called once, with numbers by which their places are found.
        count: how many numbers there are.

    Raises:
        ValueError: a number or the stamp does not stand in the serialised message as it is.
    """

    def __init__(
        self,
        message: Any,
        stamp: Any,
        put: Callable[[Sequence[float]], None] = lambda _: None,
        count: int = 0,
    ) -> None:
        marks = [float.fromhex(f"0x1.{0xA5C3F17 + k:x}p-400") for k in range(count)]
        stamp.sec, stamp.nanosec = _SECONDS, _NANOSECONDS
        put(marks)
        self._bytes = bytearray(serialize_message(message))
        order = "<" if self._bytes[1] & 1 else ">"
        self._stamp = struct.Struct(f"{order}iI")
        self._stamp_at = self._place(self._stamp.pack(_SECONDS, _NANOSECONDS))
        places = [self._place(struct.pack(f"{order}d", mark)) for mark in marks]
        self._runs = [
            (struct.Struct(f"{order}{last - first}d"), places[first], first, last) for first, last in _runs(places)
        ]

    def _place(self, piece: bytes) -> int:
        if self._bytes.count(piece) != 1:
            raise ValueError(f"{piece.hex()} does not stand once in the serialised message")
        return self._bytes.index(piece)

    def with_values(self, stamp: int, values: Sequence[float] = ()) -> bytes:
        """Return the message of a time [ns] with these numbers."""
        self._stamp.pack_into(self._bytes, self._stamp_at, *divmod(stamp, NANOSECONDS))
        for run, place, first, last in self._runs:
            run.pack_into(self._bytes, place, *values[first:last])
        return bytes(self._bytes)


def _runs(places: Sequence[int]) -> list[tuple[int, int]]:
    """Numbers that stand one behind another: the first of each run and the one after its last."""
    begins = [k for k, place in enumerate(places) if k == 0 or place != places[k - 1] + 8]
    return list(pairwise([*begins, len(places)]))
