"""Brings the topics of a recording onto one clock: jumps are cut off, different clocks are aligned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from eha_core.recording.samples import LONGEST_GAP
from eha_core.recording.topic_columns import DecodedTopic

_CLOCKS_DIFFER = 1_000_000_000  # [ns]: longer than any transport takes
_LONE = 5  # messages of which less than half may be out of order without a jump of the clock
_LEAP_BACK = 100_000_000  # [ns]: further than messages overtake each other


def without_leaps(topics: Sequence[DecodedTopic]) -> tuple[list[DecodedTopic], tuple[str, ...]]:
    """Keep the stretch with most messages between two jumps of the stamps' clock, the same for all topics.

    After a clock was set, every topic has samples from both sides; if each topic chose its own side, samples of
    different times would be combined.
    """
    edges = sorted({int(edge) for topic in topics if len(topic.logged) for edge in topic.logged[1:][_leaps(topic)]})
    if not edges:
        return list(topics), ()
    sides = [np.searchsorted(edges, topic.logged, side="right") for topic in topics]
    fullest = int(np.argmax(np.bincount(np.concatenate(sides), minlength=len(edges) + 1)))
    kept = []
    for topic, side in zip(topics, sides, strict=True):
        here = side == fullest
        columns = {name: values[here] for name, values in topic.columns.items()}
        stamps, logged = topic.stamps[here], topic.logged[here]
        lead = int(np.median(logged - stamps)) if len(stamps) else topic.lead
        kept.append(replace(topic, stamps=stamps, logged=logged, lead=lead, columns=columns))
    lost = sum(int(np.count_nonzero(side != fullest)) for side in sides)
    return kept, (f"the clock of the stamps leapt; {lost} messages before or after were left out",)


def _leaps(topic: DecodedTopic) -> NDArray[np.bool_]:
    """Flags of the messages, without the first, before which the stamps jump for good, though the log times do not."""
    steps, passed = np.diff(median_filter(topic.stamps, _LONE, mode="nearest")), np.diff(topic.logged)
    return np.asarray((passed >= 0) & ((steps < -_LEAP_BACK) | (steps - passed > LONGEST_GAP)))


def on_one_clock(topics: Sequence[DecodedTopic]) -> tuple[list[DecodedTopic], tuple[str, ...]]:
    """Shift every topic to the recorder's clock where their own clocks differ, as simulation and wall time do."""
    filled = [topic for topic in topics if len(topic.stamps)]
    leads = [topic.lead for topic in filled]
    if not leads or max(leads) - min(leads) <= _CLOCKS_DIFFER:
        return list(topics), ()
    apart = (max(leads) - min(leads)) / 1e9
    shifted = [replace(topic, stamps=topic.stamps + topic.lead, lead=0) for topic in topics]
    names = ", ".join(topic.name for topic in filled)
    return shifted, (f"the clocks of {names} lie up to {apart:.3g} s apart; their stamps were set by the log times",)
