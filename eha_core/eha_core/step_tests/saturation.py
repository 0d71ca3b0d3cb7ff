"""Whether the speed over the level is straight, saturates, or is bent in another way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import f as fisher

from eha_core.step_tests.line import SIGNIFICANT, fit_line, mean_of
from eha_core.step_tests.result import Array, Estimate, Flags, Integers

FLAT = 0.2
"""Share of the gain below which the speed no longer rises with the level (assumed)."""

FEWEST = 5
"""Fewest steps that tell a bend from scatter: a parabola and two to spare."""


@dataclass(frozen=True)
class Straightness:
    """What the speeds do: `straight` flags the steps on the line, `limit` is the speed of the others.

    `is_bent` says that they follow no line, and no line with a limit either.
    """

    straight: Flags
    limit: Estimate | None = None
    is_bent: bool = False


def straightness(levels: Array, groups: Integers, speeds: list[Estimate]) -> Straightness:
    """Compare a line, a line with a limit, and a parabola.

    Args:
        levels: (n,) levels of the steps.
        groups: (n,) number of each step's level, the smallest 0.
        speeds: the n speeds.
    """
    everything = np.ones(levels.size, dtype=bool)
    if levels.size < FEWEST or np.unique(groups).size < 3:
        return Straightness(everything)
    ones = np.ones(levels.size)
    weights = fit_line([ones, levels], speeds).weights
    values = np.array([speed.value for speed in speeds])
    line = _squares([ones, levels], values, weights)
    parabola = _squares([ones, levels, levels**2], values, weights)
    knees = np.linspace(np.unique(levels)[1], np.max(levels), 60)
    limited = [_squares([ones, np.minimum(levels, knee)], values, weights) for knee in knees]
    spare = levels.size - 3
    if not any(_is_better(line, other, spare) for other in (parabola, min(limited))):
        return Straightness(everything)
    knee = float(knees[int(np.argmin(limited))])
    beyond = levels > knee - 0.01 * float(np.max(levels))
    if min(limited) < parabola and _is_flat(levels, groups, values, beyond):
        return Straightness(~beyond, mean_of([speed for speed, flat in zip(speeds, beyond, strict=True) if flat]))
    return Straightness(everything, is_bent=True)


def _squares(columns: list[Array], values: Array, weights: Array) -> float:
    root = np.sqrt(weights)
    design = np.column_stack(columns) * root[:, None]
    left = root * values - design @ np.linalg.lstsq(design, root * values, rcond=None)[0]
    return float(left @ left)


def _is_better(simple: float, larger: float, spare: int) -> bool:
    """Whether one more value lowers the squares by more than chance."""
    if larger <= 0.0:
        return simple > 0.0
    return bool(fisher.sf((simple - larger) * spare / larger, 1, spare) < SIGNIFICANT)


def _is_flat(levels: Array, groups: Integers, values: Array, beyond: Flags) -> bool:
    """Whether two levels at least lie beyond the knee without a gain, and a line's two levels below it."""
    if np.unique(groups[beyond]).size < 2 or np.unique(groups[~beyond]).size < 2:
        return False
    above, below = (np.polyfit(levels[part], values[part], 1)[0] for part in (beyond, ~beyond))
    return bool(abs(above) < FLAT * abs(below))
