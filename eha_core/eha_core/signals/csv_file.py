"""A signal from a CSV file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import ParameterError, RecordingError
from eha_core.signals.signal import FloatArray, Signal, described
from eha_core.tables import read_table


@dataclass(frozen=True)
class CsvFile(Signal):
    """The values of one column over the column `time` [s], with straight lines between them.

    Time counts from the file's first row; after the last row the last value holds. With `hold` the values stay until
    the next row instead.
    """

    path: str = described("", "path of the CSV file, which has a header row")
    column: str = described("", "column of the values; empty: the first that is not `time`")
    scale: float = described(1.0, "factor to V or m")
    hold: bool = described(False, "whether values hold until the next row")

    def check_together(self) -> None:
        """Read the file, so that what is wrong with it is said at once; nothing is read before a path is given."""
        if self.path:
            _ = self._rows

    @cached_property
    def _rows(self) -> tuple[FloatArray, FloatArray]:
        try:
            columns = read_table(Path(self.path)).columns
        except RecordingError as error:
            raise ParameterError(f"csv_file.path: {error}") from error
        others = [name for name in columns if name != "time"]
        column = self.column or (others[0] if others else "")
        for name in ("time", column):
            if name not in columns:
                raise ParameterError(f"csv_file: {self.path} has no column {name!r}; it has {', '.join(columns)}")
        usable = np.isfinite(columns["time"]) & np.isfinite(columns[column])
        time, values = columns["time"][usable], columns[column][usable]
        if not len(time) or np.any(np.diff(time) <= 0.0):
            raise ParameterError(f"csv_file: {self.path} needs rows of numbers whose time increases")
        return time - time[0], values * self.scale

    def shape(self, time: FloatArray) -> FloatArray:
        """The file's values."""
        if not self.path:
            raise ParameterError("csv_file.path is empty; name a CSV file")
        instants, values = self._rows
        if self.hold:
            return np.asarray(values[self._row_before(instants, time)])
        return np.asarray(np.interp(time, instants, values))

    def slope(self, time: FloatArray) -> FloatArray:
        """The lines' slopes; zero after the last row and where values hold."""
        instants, values = self._rows
        if self.hold:
            return np.zeros_like(time)
        slopes = np.append(np.diff(values) / np.diff(instants), 0.0)
        return np.asarray(slopes[self._row_before(instants, time)])

    @staticmethod
    def _row_before(instants: FloatArray, time: FloatArray) -> NDArray[np.int64]:
        return np.asarray(np.searchsorted(instants, time * (1.0 + 1e-12), side="right") - 1)
