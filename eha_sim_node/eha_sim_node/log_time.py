"""The log time of a recorded message, in wall-clock time or in simulated time."""

from __future__ import annotations

import struct
from bisect import bisect_right
from collections import deque

from eha_core.realtime import NANOSECONDS

_STAMP = {1: struct.Struct("<iI"), 0: struct.Struct(">iI")}
_ENCAPSULATION = 4
_CLOCKS_KEPT = 20_000


def leading_stamp(data: bytes) -> int:
    """Return the time [ns] that serialised bytes begin with: a header's stamp, or the content of a Clock."""
    seconds, nanoseconds = _STAMP[data[1] & 1].unpack_from(data, _ENCAPSULATION)
    return int(seconds) * NANOSECONDS + int(nanoseconds)


class SimulatedTime:
    """Says which simulated time it was when a message was published.

    A message without stamp has only its publication's wall-clock time. The simulated time then in force is that of the
    last /clock published before it, whatever order the two arrive in: exact as far as the publishers share a clock.
    """

    def __init__(self) -> None:
        self._published: deque[int] = deque(maxlen=_CLOCKS_KEPT)
        self._simulated: deque[int] = deque(maxlen=_CLOCKS_KEPT)

    def tick(self, published: int, simulated: int) -> None:
        """Note a /clock: when it was published (wall clock) and what it says [ns]."""
        self._published.append(published)
        self._simulated.append(simulated)

    def certain(self, published: int) -> bool:
        """Whether every /clock that precedes a message published then is known."""
        return bool(self._published) and self._published[-1] > published

    def at(self, published: int) -> int:
        """Return the simulated time [ns] in force at a wall-clock time; zero before the first /clock."""
        index = bisect_right(self._published, published)
        return self._simulated[index - 1] if index else 0
