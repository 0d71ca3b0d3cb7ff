"""What was fitted so far: the best fit of each hypothesis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from eha_core.diagnosis.hypothesis import Hypothesis
from eha_core.identification.fit import Fit

OUT_OF_REACH = 200.0
"""A hypothesis that cannot come within this of the best objective so far is not fitted to its end."""

CONVERGE_WITHIN = 300.0
"""The best few are fitted to their end, those at least that came within this of the best; in a comparison of what has
not converged yet, or within half of what the best left over."""

MOST_FITS = 700
"""Fits of proposed sets after which a search goes over to settling what it has. Of 81 searches in sets of four to six
effects (development cases, seeds 61331 and 84417) the longest made 430. Of the four of seed 70219 that were seen to
make more than 600, three were lost (three-0016, three-0018, rig-0022) and one, rig-0002, was right after 846."""

Progress = Callable[[str], None]
"""Receives what is being tried."""

Found = dict[Hypothesis, Fit]
"""The best fit so far of each hypothesis."""


@dataclass
class Effort:
    """How many sets a search has fitted, over long windows and short ones."""

    fits: int = 0


def keep_better(found: Found, hypothesis: Hypothesis, result: Fit) -> None:
    """Add a fitted hypothesis, or let it take the place of a worse fit of the same one."""
    if hypothesis not in found or result.objective < found[hypothesis].objective:
        found[hypothesis] = result


def best_first(found: Found) -> list[Hypothesis]:
    """The hypotheses in the order of their objectives, the lowest first."""
    return sorted(found, key=lambda hypothesis: found[hypothesis].objective)
