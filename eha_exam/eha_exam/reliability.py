"""Whether stated probabilities are what comes true: a reliability diagram, as a table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import fmean

from eha_exam.scoring import Mark, Proportion

EDGES = (0.0, 0.5, 0.8, 0.95, 0.99, 1.0)
"""Of the bins: most names are stated to be nearly sure, so bins of one width would say nothing of them."""

FEWEST = 20
"""Names in a bin below which their share says too little of it."""

APART = 0.05
"""By which stated and observed probability may differ."""


@dataclass(frozen=True)
class Bin:
    """The names whose stated probability lies from `low` to `high`: the mean that is `stated`, and what is observed."""

    low: float
    high: float
    stated: float
    observed: Proportion


def reliability(marks: Sequence[Mark]) -> Iterator[Bin]:
    """The bins of stated probabilities in which there is a name."""
    names = [name for mark in marks for name in mark.probabilities]
    for low, high in zip(EDGES, EDGES[1:], strict=False):
        inside = [(stated, true) for stated, true in names if low <= stated < high or stated == high == EDGES[-1]]
        if inside:
            stated, true = zip(*inside, strict=True)
            yield Bin(low, high, fmean(stated), Proportion(sum(true), len(true)))
