"""A relation that must hold between the channels of a recording, and distances of ratios from one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

Values = Mapping[str, float]


@dataclass(frozen=True)
class Relation:
    """A relation that must hold: its name, the value found, whether that is certainly wrong or certainly right (it may
    be neither), and its distance from the ideal, as a logarithm or in units of its own bound."""

    name: str
    value: float
    broken: bool
    sound: bool
    distance: float


def within(ratio: float, bound: float) -> bool:
    """Whether a ratio is between 1 / bound and bound."""
    return 1.0 / bound < ratio < bound


def off_by(ratio: float) -> float:
    """The absolute logarithm of a ratio's magnitude."""
    return abs(float(np.log(abs(ratio) + 1e-12)))
