"""Which seconds a departure is to be named from, and when it is worth naming again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from eha_core.twin.comparison import Comparison
from eha_core.twin.excerpt import Excerpt, joined
from eha_core.twin.explanation import Departure
from eha_core.twin.samples import nanoseconds

UNCERTAIN = 0.1
"""s after the stamp since when something departs: that is known to half the width of the weak form's test function."""

LEAST = 0.7
"""s that a departure must have lasted: the first 0.3 s of them bring coil and spool to what they are (assumed)."""

MOST = 10.0
"""s that it is named from at most: more costs time and shows hardly more (assumed)."""

AGAIN = 1.5
"""Factor by which these seconds must have grown to name a departure again: its interval shrinks with their root."""


class Departures:
    """Follows a twin's comparisons, and says when there is something to name."""

    def __init__(self) -> None:
        self._began: int | None = None  # of the departure named last [ns]
        self._length = 0  # of what it was named from [ns]
        self._unsound: set[str] = set()
        self._alike_from = 0  # since when the same channels are sound [ns]

    def take(
        self, comparison: Comparison, kept: Sequence[Excerpt], parameters: Mapping[str, float]
    ) -> Departure | None:
        """Take a comparison, the windows that the twin keeps and its parameters; return what is to be named, if it is
        new or more of it is known."""
        if set(comparison.unsound) != self._unsound:
            self._unsound, self._alike_from = set(comparison.unsound), comparison.start
        if not comparison.departs:
            self._began = None
            return None
        whole = joined(kept)
        began = min(comparison.departs.values())
        start = max(began + nanoseconds(UNCERTAIN), self._alike_from, whole.end - nanoseconds(MOST))
        excerpt = whole.part(start, whole.end)
        length = excerpt.end - excerpt.start
        if length < nanoseconds(LEAST) or (began == self._began and length < AGAIN * self._length):
            return None
        self._began, self._length = began, length
        return Departure(excerpt, dict(parameters), comparison.noises)
