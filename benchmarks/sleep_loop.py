"""A bare loop that sleeps until the next tick of a rate: what the machine's clock and scheduler alone allow.

Run as `python -m benchmarks.sleep_loop RATE SECONDS WINDOW`; prints the percentiles of its lateness [s], each in
its worst window of so many seconds, which is how the simulator's own report is read.
"""

from __future__ import annotations

import sys
import time

PERCENTILES = {"p50": 0.5, "p99": 0.99, "p999": 0.999}


def lateness(rate: float, seconds: float) -> list[float]:
    """Return PERCENTILES of how late [s] a loop at a rate [Hz] wakes; one sample a wake, as the node counts."""
    late = []
    tick, start = 1, time.monotonic()
    while tick <= rate * seconds:
        deadline = start + tick / rate
        time.sleep(max(0.0, deadline - time.monotonic()))
        now = time.monotonic()
        late.append(now - deadline)
        tick = max(tick, int((now - start) * rate)) + 1
    return [sorted(late)[int(share * (len(late) - 1))] for share in PERCENTILES.values()]


if __name__ == "__main__":
    loop_rate, duration, window = map(float, sys.argv[1:])
    windows = [lateness(loop_rate, window) for _ in range(round(duration / window))]
    print(*(max(several) for several in zip(*windows, strict=True)))
