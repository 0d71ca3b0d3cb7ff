"""What a trial found: a row of the table."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field


@dataclass
class Row:
    """One kind of hostility: what was tried, how often, what it did, and what it must not have done."""

    tried: str
    seed: int
    times: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)

    def count(self, outcome: str) -> None:
        """One more trial with a legitimate outcome."""
        self.times += 1
        self.outcomes[outcome] += 1

    def fail(self, what: str) -> None:
        """One more trial, which found a fault."""
        self.times += 1
        self.failures.append(what)

    def add(self, other: Row) -> None:
        """What another row counted of the same kind."""
        self.times += other.times
        self.outcomes += other.outcomes
        self.failures += other.failures

    def cells(self) -> tuple[str, ...]:
        """The row as text."""
        did = ", ".join(f"{name} {count:,}" for name, count in self.outcomes.most_common())
        return self.tried, str(self.seed), f"{self.times:,}", did, str(len(self.failures))


HEADINGS = ("tried", "seed", "times", "what came of it", "faults")


def as_markdown(rows: list[Row]) -> str:
    """The table."""
    lines = [HEADINGS, ("---",) * len(HEADINGS), *(row.cells() for row in rows)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
