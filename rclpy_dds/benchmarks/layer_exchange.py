"""One end of an exchange of messages between two processes.

Run as `python layer_exchange.py echo END KIND EVERY` and `... drive END KIND EVERY`, END one of `node` and
`plain`. The echo answers every EVERY-th message with the message itself. The driver reads numbers from its input and
prints a line for each: with EVERY 1, the round-trip times [s] of so many messages sent at 1 kHz; else the time [s] that
so many times EVERY messages took, sent back to back. Each says `ready` once it has found the other, and ends with
its input.
"""

from __future__ import annotations

import sys
import threading
import time
from typing import Any

from layer_ends import ENDS, End

PERIOD = 1e-3
LIMIT = 30.0  # s; nothing that is measured here takes as long


class Echo:
    """Sends back every so many-th message."""

    def __init__(self, end: str, kind: str, every: int, reads: str, writes: str) -> None:
        self._every, self._heard = every, 0
        self._end = ENDS[end](kind, writes, reads, self._hear)

    def _hear(self, message: Any) -> None:
        self._heard += 1
        if self._heard % self._every == 0:
            self._end.send(message)

    def run(self) -> None:
        """Answer until the input ends."""
        _ready(self._end)
        ended = threading.Event()
        threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
        while not ended.is_set():
            self._end.spin_once(0.1)


class Driver:
    """Sends and waits for answers."""

    def __init__(self, end: str, kind: str, every: int, writes: str, reads: str) -> None:
        self._every, self._answers = every, 0
        self._end = ENDS[end](kind, writes, reads, self._hear)

    def _hear(self, message: Any) -> None:
        self._answers += 1

    def run(self) -> None:
        """Measure as often as the input says."""
        _ready(self._end)
        for line in sys.stdin:
            times = self._round_trips(int(line)) if self._every == 1 else [self._burst(int(line))]
            print(*times, flush=True)

    def _round_trips(self, count: int) -> list[float]:
        times, due = [], time.perf_counter()
        for _ in range(count):
            due = max(due + PERIOD, time.perf_counter())
            time.sleep(max(0.0, due - time.perf_counter()))
            begun = time.perf_counter()
            self._end.send(self._end.message)
            self._wait(1)
            times.append(time.perf_counter() - begun)
        return times

    def _burst(self, count: int) -> float:
        begun = time.perf_counter()
        for _ in range(count * self._every):
            self._end.send(self._end.message)
        self._wait(count)
        return time.perf_counter() - begun

    def _wait(self, answers: int) -> None:
        limit = time.perf_counter() + LIMIT
        while self._answers < answers:
            self._end.spin_once(1.0)
            if time.perf_counter() > limit:
                sys.exit(f"no answer came in {LIMIT:g} s")
        self._answers -= answers


def _ready(end: End) -> None:
    limit = time.perf_counter() + LIMIT
    while not end.matched():
        time.sleep(0.01)
        if time.perf_counter() > limit:
            sys.exit(f"the other end was not found in {LIMIT:g} s")
    print("ready", flush=True)


if __name__ == "__main__":
    role, end_name, kind_name, number = sys.argv[1:]
    there, back = (f"{way}_{end_name}_{kind_name}_{number}" for way in ("there", "back"))
    made = Echo if role == "echo" else Driver
    made(end_name, kind_name, int(number), there, back).run()
