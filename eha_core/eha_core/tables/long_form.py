"""Tables in long form, as databases write them: each row has one value of one signal. They get a column per signal."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_core.tables.table import Column

MOST_SIGNALS = 200
"""Most signals of a file; a column with more different texts has no names."""
_NAMES = re.compile(
    r"_?(field|name|signal|signal_?name|channel|tag|tag_?name|variable|var|sensor|parameter|metric|series|topic|point"
    r"|item|measurement|quantity|messstelle|kanal|groesse|key|label|identifier|node_?id)",
    re.IGNORECASE,
)
_VALUES = re.compile(r"_?(value|values|val|wert|messwert|data|reading)", re.IGNORECASE)
_UNITS = re.compile(r"_?(unit|units|einheit|uom)", re.IGNORECASE)


@dataclass(frozen=True)
class LongForm:
    """The indices, from 0, of the columns of names, of values and of units; None without units."""

    names: tuple[int, ...]
    value: int
    unit: int | None = None


def long_form_of(
    names: Sequence[str], rows: Sequence[Sequence[str]], is_value: Callable[[str], bool]
) -> LongForm | None:
    """The columns of names and values; None for a table with a column for each signal.

    Args:
        names: the columns' names.
        rows: rows of cells, which show the columns' content.
        is_value: whether a cell has a number or a time.
    """
    value = [k for k, name in enumerate(names) if _VALUES.fullmatch(name.strip())]
    if len(value) != 1:
        return None
    of_text = [
        k for k, name in enumerate(names)
        if _NAMES.fullmatch(name.strip()) and (filled := [row[k] for row in rows if k < len(row) and row[k]])
        and not any(map(is_value, filled))
    ]  # fmt: skip
    unit = next((k for k, name in enumerate(names) if _UNITS.fullmatch(name.strip())), None)
    return LongForm(tuple(of_text), value[0], unit) if of_text else None


def signals_of(
    labels: Sequence[NDArray[Any]],
    values: NDArray[np.float64],
    time: Column | None,
    clock: str,
    units: NDArray[Any] | None,
) -> Iterator[tuple[str, str, Column, Column | None, str]]:
    """Each signal's name, unit, values, times and those times' unit.

    Args:
        labels: the columns of names, one text per row; those that vary name a signal together.
        values: one number per row.
        time: one time per row; None without times.
        clock: the times' unit.
        units: one text per row, where the file has units.
    """
    varying = [label for label in labels if len(set(label.tolist())) > 1] or list(labels[:1])
    joined = varying[0]
    for label in varying[1:]:
        joined = np.array([f"{one}/{two}" for one, two in zip(joined, label, strict=True)], dtype=object)
    for signal in list(dict.fromkeys(joined.tolist()))[:MOST_SIGNALS]:
        here = joined == signal
        if str(signal).strip() and np.isfinite(values[here]).any():
            unit = "" if units is None else next((str(one) for one in units[here] if one), "")
            yield str(signal), unit, values[here], None if time is None else time[here], clock
