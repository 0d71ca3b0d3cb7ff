"""How many of a timer's samples were never sent: a timer that comes late drops what it has missed, and says nothing."""

from __future__ import annotations

from collections.abc import Mapping

from eha_core.realtime import NANOSECONDS, OVERRUN_SHARE


class SampleCount:
    """Counts samples against a rate [Hz], from the first sample on.

    `missed` counts since the first sample, the share that `report` speaks of since the previous report.
    """

    def __init__(self, rate: float) -> None:
        self._period = NANOSECONDS / rate
        self.restart()

    def restart(self) -> None:
        """Begin with the next sample: the signal starts anew."""
        self._first: int | None = None
        self._latest = 0
        self._sent = 0
        self._reported = (0, 0)

    @property
    def missed(self) -> int:
        """Samples that were due up to the latest one and were not sent."""
        return max(0, self._due - self._sent)

    @property
    def _due(self) -> int:
        return 0 if self._first is None else round((self._latest - self._first) / self._period) + 1

    def sample(self, now: int) -> None:
        """Count a sample that is sent now [ns]; a clock that was set back begins anew."""
        if now < self._latest:
            self.restart()
        if self._first is None:
            self._first = now
        self._latest = now
        self._sent += 1

    def report(self) -> tuple[Mapping[str, object], list[str]]:
        """Return values and troubles for /diagnostics, and begin the next report."""
        due, missed = self._due - self._reported[0], self.missed - self._reported[1]
        self._reported = (self._due, self.missed)
        troubles = []
        if missed > OVERRUN_SHARE * due:
            share = 100 * missed / due
            troubles.append(f"{share:.0f} % of the samples were not sent: machine or /clock are slower than `rate`")
        return {"samples": self._sent, "missed": self.missed}, troubles
