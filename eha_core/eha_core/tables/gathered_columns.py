"""Columns of cells, collected part by part and converted: numbers, times, names, and unreadable cells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError
from eha_core.tables.number_cells import COMMA, POINT, is_missing, looks_like_a_number, number_of, numbers_of
from eha_core.tables.table import Column, Loss, OtherOrder
from eha_core.tables.time_cells import DAY, instants_of, is_instant

_DECIDING = 200
"""Filled cells that decide the content of a column."""
_FEWEST_OTHERWISE = 3
_MOST_OTHERWISE = 1e-3
"""Numbers written differently from the rest of their column, in number or share, below which they count as slips."""
_AT_THE_EDGE = 0.1
"""Share of a column's range that counts as its largest, or smallest, values ..."""
_FEWEST_RUNS, _FEWEST_CELLS = 3, 20
"""... fewest gaps for a loss by value, one less where at least so many cells are lost ..."""
_MOST_ELSEWHERE, _MOST_OFTEN = 0.1, 0.5
"""... and largest shares of the gaps' neighbours elsewhere, and of all values at that edge."""


class GatheredColumn:
    """One column: its cells so far."""

    def __init__(self, name: str, decimal: str = POINT, unit: str = "", is_text: bool = False) -> None:
        self.name, self.unit = name, unit
        self.is_text = is_text
        self.is_instant: bool | None = None
        self.has_date = self.has_clock = False
        self._decimal = decimal
        self._parts: list[NDArray[Any]] = []
        self._others: list[NDArray[np.int64] | None] = []
        self._month_first = False
        self.other_order: OtherOrder | None = None
        self._lost: list[NDArray[np.int64]] = []
        self._first: tuple[str, int] = ("", 0)
        self._otherwise: list[str] = []
        self._behind: set[str] = set()
        self._is_scaled = bool(unit)
        self._count = 0

    def read(self, cells: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.bool_], NDArray[np.int64] | None]:
        """Cells as values, flags of those with something else, and the times with day and month swapped."""
        if cells.dtype.kind != "O":
            return cells, np.zeros(len(cells), dtype=bool), None
        if self.is_text:
            return cells, np.zeros(len(cells), dtype=bool), None
        if self.is_instant is None:
            self._decide(cells)
        if self.is_instant:
            found = instants_of(cells)
            self.has_date, self.has_clock = self.has_date or found.has_date, self.has_clock or found.has_clock
            self._month_first |= found.month_first
            missing = np.array([not isinstance(cell, str) or is_missing(cell) for cell in cells], dtype=bool)
            exact = found.stamps if found.known.all() else np.where(found.known, found.stamps * 1e-9, np.nan)
            return exact, ~found.known & ~missing, found.other
        values, unreadable, left = _quick(cells, self._decimal)
        if len(left):
            slow = numbers_of(cells[left], self._decimal, self._is_scaled)
            values[left], unreadable[left] = slow.values, slow.unreadable
            self._behind |= slow.units
        return values, unreadable, None

    def _decide(self, cells: NDArray[Any]) -> None:
        filled = [cell for cell in cells[: 20 * _DECIDING] if isinstance(cell, str) and not is_missing(cell)][
            :_DECIDING
        ]
        if not filled:
            return
        self.is_instant = sum(map(is_instant, filled)) > 0.5 * len(filled)
        behind = {found[1] for cell in filled if (found := number_of(cell, self._decimal)) is not None}
        # Different letters after the numbers of a column are powers of ten; a single one is its unit.
        self._is_scaled = self._is_scaled or len(behind - {""}) > 1

    def add(self, cells: NDArray[Any], values: NDArray[Any], unreadable: NDArray[np.bool_], other: Any) -> None:
        """Take a part of the column after `read`."""
        if unreadable.any():
            places = np.flatnonzero(unreadable)
            self._lost.append(places + self._count)
            if not self._first[0]:
                self._first = (str(cells[places[0]]), int(places[0]) + self._count + 1)
            self._otherwise += [str(cell) for cell in cells[places] if looks_like_a_number(str(cell))]
        self._parts.append(values)
        self._others.append(other)
        self._count += len(values)

    def texts(self) -> NDArray[Any]:
        """A column of words."""
        return np.array(
            ["" if cell is None or cell != cell else str(cell) for part in self._parts for cell in part], dtype=object
        )

    def values(self, where: str) -> tuple[Column, str]:
        """The column's numbers and a remark; times are in ns, or in s where some are missing.

        Raises:
            RecordingError: many of its numbers are written differently from the rest.
        """
        if self.is_instant:
            return self._instants()
        whole = _joined(self._parts)
        readable = int(np.isfinite(whole.astype(np.float64)).sum())
        most = max(_FEWEST_OTHERWISE, _MOST_OTHERWISE * len(whole))
        if len(self._otherwise) >= most and readable > len(whole) / 2:
            raise RecordingError(
                f"{where}: {self.name!r} has {len(self._otherwise)} numbers that are written another way than the rest,"
                f" such as {self._otherwise[0]!r}; write them alike"
            )
        behind = self._behind - {""}
        if len(behind) == 1 and not self.unit:
            self.unit = next(iter(behind))
        return whole, ""

    def _instants(self) -> tuple[Column, str]:
        self.unit = "ns" if all(part.dtype.kind == "i" for part in self._parts) else "s"
        whole = self._in_ns(self._parts)
        remark = ""
        if not any(other is not None for other in self._others):
            return whole, remark
        known = np.isfinite(whole.astype(np.float64))
        parts = [part if other is None else other for part, other in zip(self._parts, self._others, strict=True)]
        swapped = np.where(known, self._in_ns(parts), whole)
        if self._month_first:  # a later date shows the order of all
            whole = swapped
        elif all(other is not None for other in self._others):
            one, other = np.ptp(whole[known]), np.ptp(swapped[known])
            # A record is more likely to pass midnight than the end of a month.
            if other == one:
                day = np.datetime64(int(whole[known][0] // (DAY if self.unit == "ns" else DAY * 1e-9)), "D")
                remark = f"assumed: {self.name}: the day stands before the month ({day}), which moves no sample"
            else:
                self.other_order = OtherOrder(bool(one < other), swapped if one < other else whole)
                whole = whole if one < other else swapped
        return whole, remark

    def _in_ns(self, parts: Sequence[NDArray[Any]]) -> NDArray[Any]:
        """The parts in one unit: ns where no cell is missing, else s."""
        if self.unit == "ns":
            return np.asarray(np.concatenate(parts))
        seconds = [part * 1e-9 if part.dtype.kind == "i" else part.astype(np.float64) for part in parts]
        return np.asarray(np.concatenate(seconds))

    def loss(self, values: Column, timed: NDArray[np.bool_] | None = None) -> Loss | None:
        """The losses of the column; None without any.

        Args:
            values: the column.
            timed: flags of the column's own rows; None: all.
        """
        missing = ~np.isfinite(values.astype(np.float64))
        lost = np.concatenate(self._lost) if self._lost else np.empty(0, dtype=np.int64)
        unread = np.zeros(len(values), dtype=bool)
        unread[lost] = True
        if timed is not None:
            missing = missing & (timed | unread)
        empty = int(np.count_nonzero(missing & ~unread))
        if not empty and not len(lost):
            return None
        return Loss(empty, len(lost), *self._first, by_value=not self.is_instant and loses_by_value(values, missing))


def _joined(parts: Sequence[NDArray[Any]]) -> Column:
    """Parts of numbers as one column; of integers if all are."""
    if all(part.dtype.kind in "iu" for part in parts):
        whole = np.concatenate(parts)
        is_exact = np.abs(whole[:1]).max(initial=0) > 2**52
        return np.asarray(whole.astype(np.int64 if is_exact else np.float64))
    return np.concatenate([part.astype(np.float64) for part in parts])


def _quick(cells: NDArray[Any], decimal: str) -> tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.int64]]:
    """The plainly written numbers of cells, read by pandas, and the places of the others."""
    import pandas

    texts = pandas.Series(cells, dtype=object)
    if decimal == COMMA:
        as_text = texts.astype(str)
        points = as_text.str.contains(POINT, regex=False)
        texts = as_text.str.replace(COMMA, POINT, regex=False).where(~points, "")
    numbers = pandas.to_numeric(texts, errors="coerce").to_numpy(dtype=np.float64, copy=True)
    # An empty cell is NaN in pandas already.
    left = np.flatnonzero(np.isnan(numbers) & np.array([isinstance(cell, str) for cell in cells], dtype=bool))
    return numbers, np.zeros(len(cells), dtype=bool), left


def loses_by_value(values: Column, missing: NDArray[np.bool_]) -> bool:
    """Whether cells are missing where a column is at its largest or smallest, by the values around each gap."""
    numbers = values.astype(np.float64)
    finite = np.isfinite(numbers)
    before, after = np.flatnonzero(missing[1:] & finite[:-1]), np.flatnonzero(missing[:-1] & finite[1:]) + 1
    lost = int(np.count_nonzero(missing))
    if len(before) < (_FEWEST_RUNS if lost < _FEWEST_CELLS else _FEWEST_RUNS - 1):
        return False
    low, high = float(numbers[finite].min()), float(numbers[finite].max())
    edge = _AT_THE_EDGE * (high - low)
    around = np.concatenate([before, after])
    for there in (numbers >= high - edge, numbers <= low + edge):
        # A column that is mostly at its largest value also loses values there by chance.
        often = float(np.mean(there[finite])) > _MOST_OFTEN
        if edge > 0.0 and not often and float(np.mean(there[around])) >= 1.0 - _MOST_ELSEWHERE:
            return True
    return False
