"""One thing that must hold between the channels of a recording, and how ratios are judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

Values = Mapping[str, float]


@dataclass(frozen=True)
class Relation:
    """One thing that must hold: its name, the value that was found, whether that is certainly wrong or certainly right
    (it may be neither), and how far it lies from the ideal, as a logarithm or in units of its own bound."""

    name: str
    value: float
    broken: bool
    sound: bool
    distance: float


def within(ratio: float, bound: float) -> bool:
    """Whether a ratio is less than so many times too large or too small."""
    return 1.0 / bound < ratio < bound


def off_by(ratio: float) -> float:
    """How far a ratio is from one, whichever way and whatever its sign, as a logarithm."""
    return abs(float(np.log(abs(ratio) + 1e-12)))
