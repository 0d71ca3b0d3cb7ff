"""How long a trial goes on: for so many seconds, or until it was made so many times."""

from __future__ import annotations

import time
from dataclasses import dataclass


@dataclass(frozen=True)
class Extent:
    """A trial's extent: `times` where it is given, else `seconds`; so many times are the same on every run. One that
    takes hours begins with the number `first`, so that it can be made in parts."""

    seconds: float = 20.0
    times: int | None = None
    first: int = 0

    def begin(self) -> Course:
        """Start the clock."""
        return Course(self, time.monotonic() + self.seconds)


@dataclass(frozen=True)
class Course:
    """A trial under way."""

    extent: Extent
    end: float

    def over(self, done: int) -> bool:
        """Whether the trial ends after it was made `done` times."""
        if self.extent.times is not None:
            return done >= self.extent.times
        return time.monotonic() >= self.end
