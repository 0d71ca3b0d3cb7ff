"""Simulated rigs, and a twin that hears them as it would hear a real one."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from eha_core.recording.simulated import Experiment, Simulated, simulate
from eha_core.signals import make_signal
from eha_core.twin import Comparison, Twin

NANOSECONDS = 1_000_000_000
PERIOD = 0.002
MULTISINE = {"amplitude": 0.12, "lowest": 0.3, "highest": 8.0, "count": 16, "period": 20.0, "seed": 5}


def rig(seconds: float, noise: float = 1.0, **options: Any) -> Simulated:
    times = np.arange(round(seconds / PERIOD)) * PERIOD
    voltages = make_signal("multisine", MULTISINE).value(times)
    return simulate(Experiment(times, voltages, seconds, noise=noise, **options))


def comparisons(
    record: Simulated, twin: Twin, published_from: int = 0, missing: tuple[float, float] = (0.0, 0.0)
) -> Iterator[tuple[float, Comparison]]:
    """Feed a record as it comes from a rig; yield each comparison with the stamp at which it was there [s]."""
    commands = dict(zip(record.commands[0].tolist(), record.commands[1].tolist(), strict=True))
    columns = [record.column(f"measured_{name}").tolist() for name in ("position", "pressure_a", "pressure_b")]
    for stamp, position, pressure_a, pressure_b in zip(record.stamps.tolist(), *columns, strict=True):
        if missing[0] * NANOSECONDS <= stamp < missing[1] * NANOSECONDS:
            continue
        twin.position(stamp, position, published_from + stamp)
        twin.pressure("a", stamp, pressure_a)
        twin.pressure("b", stamp, pressure_b)
        if stamp in commands:
            twin.command(published_from + stamp + 50_000, commands[stamp])
        comparison = twin.compare()
        if comparison is not None:
            yield stamp / NANOSECONDS, comparison


def beside(*given: Any, **options: Any) -> list[tuple[float, Comparison]]:
    """All comparisons at once."""
    return list(comparisons(*given, **options))
