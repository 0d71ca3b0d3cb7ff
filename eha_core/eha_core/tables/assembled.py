"""Makes a table of gathered columns: joins dates and clocks, finds own times, pivots signals, counts losses."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError
from eha_core.tables.gathered_columns import GatheredColumn
from eha_core.tables.long_form import LongForm, signals_of
from eha_core.tables.own_times import columns_with_times
from eha_core.tables.stated import unit_in
from eha_core.tables.table import Column, Loss, Table, distinct
from eha_core.tables.time_cells import DAY

_TIME = re.compile(
    r"(t|time|zeit|timestamp|time_?stamp|x_?value|zeitstempel|uhrzeit|date|datum|date ?time"
    r"|(abs|rel)(olute|ative)? ?time)"
)
_CLOCKS = ("time", "zeit", "timestamp")
"""Words at the end of a name of times."""
_MOSTLY, _OFTEN = 0.99, 0.5
"""Smallest shares of steps of a column of times that are not negative, and that are positive (assumed: clocks wrap and
repeat)."""
_ALIKE = 0.02
"""Largest relative difference between the usual steps of two clocks of the same rows."""
_FRACTIONS = {
    10**6: re.compile(r"(ms|msec|millis|milli ?seconds?|millisekunden?|millisec|time ?ms)", re.IGNORECASE),
    10**3: re.compile(r"(us|usec|micros|micro ?seconds?|mikrosekunden?|microsec)", re.IGNORECASE),
}
"""Names of columns with the fractions of a clock in whole seconds, by ns per count."""


def assembled(
    where: str,
    kind: str,
    columns: Sequence[GatheredColumn],
    *,
    times: Mapping[str, str] | None = None,
    rate: float | None = None,
    step: tuple[float, float] | None = None,
    long: LongForm | None = None,
    remarks: Sequence[str] = (),
) -> Table:
    """The table of columns that are complete.

    Args:
        where: the begin of messages.
        kind: the kind of file.
        columns: the columns in the order of the file.
        times: the column of a column's own times, by name.
        rate: rows per second that the file states [Hz].
        step: first value and spacing of the first column, where its cells are empty.
        long: the columns of names and values, where a row has one value of one signal.
        remarks: losses that are known already.

    Raises:
        RecordingError: no column has a number, or many numbers of one are written differently from the rest.
    """
    if long is not None:
        return _long(where, kind, columns, long, remarks)
    names, doubled = distinct([column.name for column in columns])
    said = [*remarks, *doubled]
    values: dict[str, Column] = {}
    for k, (name, column) in enumerate(zip(names, columns, strict=True)):
        found, remark = column.values(where)
        if step is not None and k == 0:
            found = step[0] + step[1] * np.arange(len(found))
        values[name] = found
        said += [remark] if remark else []
    own = dict(times or {}) or _own_times(names, [column.name for column in columns], values)
    units = {name: column.unit for name, column in zip(names, columns, strict=True) if column.unit}
    gathered = dict(zip(names, columns, strict=True))
    said += _clocks_joined(values, gathered, units)
    orders = {name: order for name in values if (order := gathered[name].other_order) is not None}
    losses: dict[str, Loss] = {}
    for name in list(values):
        column = gathered[name]
        if np.isnan(values[name].astype(np.float64)).all() and (
            not column.name or column.name in ("Comment", *own.values()) or column.name.startswith("column ")
        ):
            del values[name]
            continue
        timed = np.isfinite(values[own[name]].astype(np.float64)) if own.get(name) in values else None
        if name not in own.values() and (loss := column.loss(values[name], timed)) is not None:
            losses[name] = loss
    stated = {name: unit for name, unit in units.items() if name in values}
    own = {name: time for name, time in own.items() if name in values and time in values}
    orders = {name: order for name, order in orders.items() if name in values}
    return Table(kind, values, stated, tuple(said), own, rate, losses, orders)


def _own_times(names: Sequence[str], plain: Sequence[str], values: Mapping[str, Column]) -> dict[str, str]:
    """The column of times of each column, in a file with one before each signal or each of several tables."""
    is_time = [_is_time(_bare(bare)) and _rises(values[name]) for name, bare in zip(names, plain, strict=True)]
    places = [k for k, one in enumerate(is_time) if one]
    if len(places) < 2 or places[0] != 0 or is_time[-1] or any(b - a == 1 for a, b in pairwise(places)):
        return {}
    if len({_bare(plain[k]) for k in places}) > 1 and _are_alike([values[names[k]] for k in places]):
        return {}
    return {name: names[max(place for place in places if place < k)] for k, name in enumerate(names) if not is_time[k]}


def _is_time(bare: str) -> bool:
    words = re.split(r"[^a-z]+", bare)
    return _TIME.fullmatch(bare) is not None or _TIME.fullmatch(words[0]) is not None or words[-1] in _CLOCKS


def _rises(values: Column) -> bool:
    """Whether values increase like times, unlike a tank's pressure or the oil's temperature, `T_oil`."""
    steps = np.diff(values[np.isfinite(values.astype(np.float64))])
    return len(steps) == 0 or bool(np.mean(steps >= 0) >= _MOSTLY and np.mean(steps > 0) >= _OFTEN)


def _are_alike(clocks: Sequence[Column]) -> bool:
    """Whether columns of times have the same rows, and differ only in unit and origin."""
    numbers = [clock.astype(np.float64) for clock in clocks]
    if len({int(np.isfinite(one).sum()) for one in numbers}) > 1:
        return False
    steps = [float(np.nanmedian(np.abs(np.diff(one)))) for one in numbers]
    ratios = [step / steps[0] if steps[0] > 0.0 else 1.0 for step in steps]
    of_units = [10.0**power for power in range(-12, 13)] + [60.0, 1.0 / 60.0, 86400.0, 1.0 / 86400.0]
    return all(any(abs(ratio / one - 1.0) < _ALIKE for one in of_units) for ratio in ratios)


def _bare(name: str) -> str:
    """A name without its unit, number and channel: `Time (s) - ch 1` is `time`."""
    unit = unit_in(name)
    text = re.sub(r"[\[(<{][^\])>}]*[\])>}]", " ", name) if unit else name
    text = re.sub(r"\s+-\s+.*$", "", text.strip().lower())
    text = re.sub(r"[_ ](s|ms|us|ns|sec)$", "", text)
    return re.sub(r"[_ ]*\d+$", "", text).strip()


def _clocks_joined(
    values: dict[str, Column], gathered: Mapping[str, GatheredColumn], units: dict[str, str]
) -> list[str]:
    """Join a column of dates to one of clocks, and one of fractions to a clock of whole seconds; return remarks."""
    said = []
    instants = [name for name in values if gathered[name].is_instant and values[name].dtype.kind == "i"]
    dates = [name for name in instants if gathered[name].has_date and not gathered[name].has_clock]
    clocks = [name for name in instants if gathered[name].has_clock and not gathered[name].has_date]
    if len(dates) == 1 and len(clocks) == 1:
        date, clock = dates[0], clocks[0]
        if (order := gathered[date].other_order) is not None:
            gathered[clock].other_order = replace(order, swapped=order.swapped // DAY * DAY + values[clock])
        values[clock] = values[date] // DAY * DAY + values[clock]
        gathered[clock].has_date = True
        del values[date]
        said.append(f"{date} and {clock} are one time, called {clock}")
    for name in [name for name in instants if name in values and gathered[name].has_clock]:
        for size, called in _FRACTIONS.items():
            fraction = next((other for other in values if called.fullmatch(other.strip(" []()"))), None)
            if fraction is not None and _fills(values[name], values[fraction], size):
                added = np.round(values[fraction]).astype(np.int64) * size
                values[name] = values[name] + added
                if (order := gathered[name].other_order) is not None:
                    gathered[name].other_order = replace(order, swapped=order.swapped + added)
                del values[fraction]
                said.append(f"{name} and {fraction} are one time, called {name}")
    for name in list(units):
        if name not in values:
            del units[name]
    return said


def _fills(stamps: Column, counts: NDArray[np.generic], size: int) -> bool:
    """Whether counts are the fractions of stamps in whole seconds."""
    numbers = counts.astype(np.float64)
    return bool(
        not (stamps % 10**9).any()
        and np.isfinite(numbers).all()
        and numbers.min() >= 0.0
        and numbers.max() * size < 1e9
    )


def _long(where: str, kind: str, columns: Sequence[GatheredColumn], long: LongForm, remarks: Sequence[str]) -> Table:
    read = [("", None) if column.is_text else column.values(where) for column in columns]
    times: dict[str, Column] = {}
    for k, column in enumerate(columns):
        values = read[k][0]
        if k != long.value and not column.is_text and isinstance(values, np.ndarray) and _goes_on(values):
            times[column.name] = values
    order = sorted(times, key=lambda name: (_TIME.fullmatch(name.strip("_ ").lower()) is None, name))
    value = np.asarray(read[long.value][0]).astype(np.float64)
    unit = columns[long.unit].texts() if long.unit is not None else None
    time = next((column for column in columns if order and column.name == order[0]), None)
    signals = list(
        signals_of(
            [columns[k].texts() for k in long.names], value, times[order[0]] if order else None,
            time.unit if time else "", unit,
        )
    )  # fmt: skip
    if not signals:
        raise RecordingError(f"{where}: holds no signal with numbers")
    loss = columns[long.value].loss(value)
    said = [*remarks, f"each row holds one value of one signal; its {len(signals)} signals are columns here"]
    said += [f"of the values, {loss}"] if loss is not None else []
    said += [
        f"assumed: {column.name}: the {'day' if column.other_order.day_first else 'month'} stands first, which makes"
        " the shorter record"
        for column in columns if column.other_order is not None
    ]  # fmt: skip
    found = columns_with_times(kind, signals)
    return replace(found, remarks=(*said, *found.remarks))


def _goes_on(values: Column) -> bool:
    """Whether a column in long form may be a time: it changes, and it has a value in every row."""
    numbers = values.astype(np.float64)
    return bool(
        np.isfinite(numbers).all()
        and len(numbers) > 1
        and len(np.unique(numbers[:1000])) > min(len(numbers), 1000) // 20
    )
