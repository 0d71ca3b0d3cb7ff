"""The columns of times of other columns: of signals with their own times, and of vectors of several lengths."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from os.path import commonprefix

import numpy as np

from eha_core.tables.table import Column, Table, distinct

_TIME = re.compile(r"(.*[._/ ])?(t|time|tout|times|timestamps?|zeit|x_?value|x\.data)(\[0\])?", re.IGNORECASE)


def columns_with_times(kind: str, signals: Iterable[tuple[str, str, Column, Column | None, str]]) -> Table:
    """A table of signals, each with its name, unit, values, times (None without any) and the times' unit.

    Signals with the same times share one column of them.
    """
    signals = list(signals)
    names, remarks = distinct([signal[0] for signal in signals])
    columns: dict[str, Column] = {}
    units: dict[str, str] = {}
    own: dict[str, str] = {}
    clocks: list[tuple[str, Column]] = []
    for name, (_, unit, values, time, time_unit) in zip(names, signals, strict=True):
        if time is not None:
            clock = next(
                (one for one, known in clocks if len(known) == len(time) and np.array_equal(known, time)), None
            )
            if clock is None:
                clock = "time" if not clocks and "time" not in names else f"{name} time"
                clocks.append((clock, time))
                columns[clock] = time
                if time_unit:
                    units[clock] = time_unit
            own[name] = clock
        columns[name] = values
        if unit:
            units[name] = unit
    return Table(kind, columns, units, remarks, own if len(clocks) > 1 or len(own) < len(names) else {})


def by_length(columns: Mapping[str, Column]) -> dict[str, str]:
    """The time of each vector among vectors of several lengths: the one of its length with the nearest path."""
    lengths = {len(values) for values in columns.values()}
    times = {name: values for name, values in columns.items() if _TIME.fullmatch(name) and _increases(values)}
    if len(lengths) < 2 or not times:
        return {}
    own = {}
    for name, values in columns.items():
        fitting = [time for time in times if len(times[time]) == len(values)]
        if name not in times and fitting:
            own[name] = max(fitting, key=lambda time: len(commonprefix([time, name])))
    return own


def _increases(values: Column) -> bool:
    return len(values) > 1 and bool(np.all(np.diff(values) > 0))
