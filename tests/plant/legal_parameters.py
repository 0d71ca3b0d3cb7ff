"""Draw any legal parameters: positive ranges by order of magnitude, with the bounds themselves among the values."""

from __future__ import annotations

import numpy as np

from eha_core.parameter import Parameter
from eha_core.parameters import NOMINAL


def draw(row: Parameter, generator: np.random.Generator) -> float:
    """A value within the row's bounds; each bound comes up in a tenth of the draws."""
    chance = generator.random()
    if chance < 0.2:
        return row.lower if chance < 0.1 else row.upper
    if row.lower < 0.0:
        return float(generator.uniform(row.lower, row.upper))
    least = max(row.lower, 1e-9 * row.upper)
    return float(np.exp(generator.uniform(np.log(least), np.log(row.upper))))


def draw_nominal(generator: np.random.Generator) -> dict[str, float]:
    """A whole legal set of the nominal plant's parameters."""
    values = {row.name: draw(row, generator) for row in NOMINAL}
    if values["return_pressure"] >= values["supply_pressure"]:
        values["return_pressure"] = 0.5 * values["supply_pressure"]
    return values


def wild_voltages(generator: np.random.Generator, count: int) -> np.ndarray:
    """Jumps of any size a controller gone wrong could ask for, each held for some steps."""
    size = 10.0 ** generator.uniform(-3.0, 12.0)
    return np.repeat(size * generator.normal(size=count // 20 + 1), 20)[:count]
