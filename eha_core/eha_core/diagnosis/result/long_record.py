"""A long record, of which only stretches were fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class JudgedBlock:
    """A block of a long record, from `start` to `end` [s]: whether it was fitted, and the RMSE of each channel [its
    unit] under the nominal model (`before`) and the final one (`after`), with their parameters held."""

    start: float
    end: float
    fitted: bool
    before: Mapping[str, float]
    after: Mapping[str, float]


@dataclass(frozen=True)
class LongRecord:
    """A long record, of which only stretches were fitted, and the errors of the model over all of it.

    Attributes:
        path: where it was read from.
        duration: [s].
        stretches: begin and end of the fitted stretches [s].
        window: s after which the piston's state is fitted again for the comparison; the parameters are held.
        blocks: the blocks that could be compared, in order.
        passed_over: s that could not be compared, such as those of a rig at rest.
        departs: intervals [s] in which the model's error is far larger than on any fitted stretch.
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
