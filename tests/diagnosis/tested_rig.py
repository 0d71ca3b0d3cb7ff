"""A planned test as the tests here use it: a gentle start, six seconds of a multisine."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from eha_core.detectability.planned import NOISE, PlannedTest, RigAsModelled, linearised
from eha_core.diagnosis.search.columns import Column, columns_of
from eha_core.effects import effect
from eha_core.nominal import nominal_of
from eha_core.signals import from_text

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tools.detection_trials import measuring

SIGNAL = from_text("multisine:amplitude=0.12,lowest=0.3,highest=8,count=16,period=20,seed=5")


def planned(channels: tuple[str, ...] = tuple(NOISE), noise: float = 1.0, duration: float = 6.0) -> PlannedTest:
    times = np.arange(round(500 * duration)) / 500.0
    voltages = np.asarray(SIGNAL.value(times)) * np.minimum(1.0, times / 0.3)
    return PlannedTest(times, voltages, duration, channels, noise)


def at(**how: object) -> RigAsModelled:
    return linearised(nominal_of({}), planned(**how))


def column_of(name: str, **values: float) -> Column:
    """The one column of an effect at these sizes and shapes."""
    full = {f"{name}.{short}": value for short, value in values.items()}
    sizes = tuple(f"{name}.{row.name}" for row in effect(name).parameters if row.switches and row.name in values)
    return Column(effect(name), full, sizes, 0, all(value >= 0.0 for value in values.values()))


__all__ = ["at", "column_of", "columns_of", "measuring", "planned"]
