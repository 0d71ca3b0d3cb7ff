"""What a recording covers of each topic: from when to when, how often, and the longest time without a message."""

from __future__ import annotations

from dataclasses import dataclass

RECORD = "eha_coverage"
"""Name of the metadata record: topic -> `count`, `first`, `last` and the longest gap as `gap_start`, `gap_end` [ns]."""


@dataclass
class Span:
    """One topic's messages: how many, the first and the last stamp [ns], and the longest gap between two of them."""

    count: int
    first: int
    last: int
    gap: tuple[int, int]

    def add(self, stamp: int) -> None:
        """Count one more message."""
        self.count += 1
        if stamp - self.last > self.gap[1] - self.gap[0]:
            self.gap = (self.last, stamp)
        self.first, self.last = min(self.first, stamp), max(self.last, stamp)


class Coverage:
    """Counts messages as they are written."""

    def __init__(self) -> None:
        self.topics: dict[str, Span] = {}

    def add(self, topic: str, stamp: int) -> None:
        """Count a message of a topic by its log time [ns]."""
        span = self.topics.get(topic)
        if span is None:
            self.topics[topic] = Span(1, stamp, stamp, (stamp, stamp))
        else:
            span.add(stamp)

    def as_record(self) -> dict[str, str]:
        """The metadata record."""
        return {
            topic: f"count={span.count} first={span.first} last={span.last}"
            f" gap_start={span.gap[0]} gap_end={span.gap[1]}"
            for topic, span in sorted(self.topics.items())
        }
