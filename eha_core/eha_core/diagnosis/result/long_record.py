"""A long record of which stretches were fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class JudgedBlock:
    """A block of a long record, from `start` to `end` [s]: whether the fit saw it, and what the nominal model
    (`before`) and the one that was found (`after`) err by in each channel with their parameters held [its unit]."""

    start: float
    end: float
    fitted: bool
    before: Mapping[str, float]
    after: Mapping[str, float]


@dataclass(frozen=True)
class LongRecord:
    """A record of which stretches were fitted, and what the whole of it says of the model that was found.

    Attributes:
        path: where it was read from.
        duration: [s].
        stretches: when those that were fitted begin and end [s].
        window: s after which the piston's state is fitted anew where the models are judged; their parameters are not.
        blocks: the blocks that could be compared, in their order.
        passed_over: s that could not, as those of a rig at rest.
        departs: spans [s] in which the model errs by far more than on any stretch that was fitted.
        statement: all this in words.
    """

    path: str
    duration: float
    stretches: tuple[tuple[float, float], ...]
    window: float
    blocks: tuple[JudgedBlock, ...]
    passed_over: float
    departs: tuple[tuple[float, float], ...]
    statement: str
