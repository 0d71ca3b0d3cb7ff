"""Reads MAT files: version 5 with SciPy, version 7.3, which is HDF5, with h5py."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from io import BytesIO
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from eha_core.errors import RecordingError
from eha_core.tables.mat5_elements import unpacked
from eha_core.tables.optional import required
from eha_core.tables.own_times import by_length
from eha_core.tables.table import LARGEST, MOST_COLUMNS, Column, Table, as_column, distinct, refuse_large

DEEPEST = 8
"""Most levels of nested structures; a logged Simulink data set has four."""
MOST_ELEMENTS = 2**16
"""Most elements of all structure and cell arrays; a recorder writes one for each signal."""
_HDF5 = b"\x89HDF\r\n\x1a\n"
_LABELS = ("Name", "name", "label", "SignalName")
_VALUES = ("Data", "data", "values", "Values")


def read_mat_table(path: Path) -> Table:
    """Read the vectors of a MAT file, those inside structures by their path, such as `rec.Y.pressure`.

    A structure array whose elements have a name and data, as recorders write signals, gives one column per signal. A
    matrix gives one column for each of its rows or columns, whichever are fewer.

    Raises:
        RecordingError: the file is damaged, of another kind, or too large.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise RecordingError(f"{path}: is larger than {LARGEST / 1e9:.1f} GB; cut it, or convert it to MCAP")
        with path.open("rb") as file:
            head = file.read(520)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from error
    # MATLAB puts its own 512 bytes before those of HDF5.
    read = _version_73 if _HDF5 in (head[:8], head[512:]) else _version_5
    gathered = _Gathered(str(path))
    try:
        read(path, gathered)
    except RecordingError:
        raise
    except Exception as error:  # a damaged byte leads SciPy and h5py to whatever Python can raise
        raise RecordingError(f"{path}: cannot be read as a MAT file ({error})") from error
    if not gathered.columns:
        raise RecordingError(f"{path}: holds no vector of numbers")
    gathered.name_rows()
    names, doubled = distinct([name for name, _ in gathered.columns])
    said = (*doubled, *gathered.remarks)
    columns = {name: values for name, (_, values) in zip(names, gathered.columns, strict=True)}
    units = {n: unit for n, unit in gathered.units.items() if n in columns}
    return Table("mat", columns, units, said, by_length(columns))


class _Gathered:
    """The columns found so far, within the limits."""

    def __init__(self, where: str) -> None:
        self.columns: list[tuple[str, Column]] = []
        self.units: dict[str, str] = {}
        self.remarks: list[str] = []
        self._where = where
        self._texts: list[tuple[str, list[str]]] = []
        self._matrices: dict[str, int] = {}
        self._cells = 0
        self._longest = 0
        self._elements = 0

    def count(self, shape: Sequence[int]) -> None:
        """Count an array's numbers before they are read or copied. Raises RecordingError where there are too many."""
        self._cells += prod(shape)
        self._longest = max(self._longest, *shape, 1)
        refuse_large(self._where, self._cells, len(self.columns), self._longest)

    def element(self) -> None:
        """Count an element of a structure or cell array."""
        self._elements += 1
        if self._elements > MOST_ELEMENTS:
            raise RecordingError(f"{self._where}: its structures have more than {MOST_ELEMENTS} elements; keep fewer")

    def add(self, path: str, values: Any) -> None:
        """Take an array: a vector as one column, a matrix as several; anything else than numbers is skipped."""
        array = np.squeeze(np.asarray(values))
        column = as_column(array)
        if column is None or array.ndim not in (1, 2) or max(array.shape) < 2:
            return
        self.count(array.shape)
        if array.ndim == 1:
            self.columns.append((path, column))
            return
        rows = column if column.shape[0] <= column.shape[1] else column.T
        self._matrices[path] = len(rows)
        for k, row in enumerate(rows[:MOST_COLUMNS]):
            self.columns.append((f"{path}[{k}]", row))

    def texts(self, path: str, texts: Sequence[Any]) -> None:
        """Take a list of texts, which may be the names of a matrix's columns."""
        if texts and all(isinstance(text, str) and text.strip() for text in texts):
            self._texts.append((path, [text.strip() for text in texts]))

    def name_rows(self) -> None:
        """Name a matrix' columns by the list of as many texts, if there is exactly one for it."""
        for path, count in self._matrices.items():
            lists = [texts for _, texts in self._texts if len(texts) == count and len(set(texts)) == count]
            alike = [other for other, rows in self._matrices.items() if rows == count]
            if len(lists) == 1 and len(alike) == 1:
                made = {f"{path}[{k}]": text for k, text in enumerate(lists[0])}
                self.columns = [(made.get(name, name), values) for name, values in self.columns]
                self.remarks.append(f"the columns of {path} are called by the file's list of {count} names")


def _version_5(path: Path, gathered: _Gathered) -> None:
    from scipy.io import loadmat

    content, left_out = unpacked(path.read_bytes())
    if left_out:
        gathered.remarks.append(f"{left_out} variables that are objects, tables, functions or sparse were left out")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        variables = loadmat(BytesIO(content), squeeze_me=True, struct_as_record=True, chars_as_strings=True)
    for name, value in variables.items():
        if not name.startswith("__"):
            _walk_5(name, value, gathered, DEEPEST)


def _walk_5(path: str, value: Any, gathered: _Gathered, levels: int) -> None:
    gathered.element()
    fields = getattr(getattr(value, "dtype", None), "names", None)
    if fields is None:
        if isinstance(value, np.ndarray) and value.dtype.kind in "OU" and value.size > 1:
            gathered.texts(path, [str(cell) if isinstance(cell, str) else cell for cell in np.ravel(value).tolist()])
        if isinstance(value, np.ndarray) and value.dtype.kind == "O" and levels:
            for k, cell in enumerate(np.ravel(value)):
                _walk_5(f"{path}{{{k}}}", cell, gathered, levels - 1)
        elif isinstance(value, np.ndarray):
            gathered.add(path, value)
        return
    if not levels:
        return
    elements = [value] if np.ndim(value) == 0 else list(np.ravel(value))
    for k, element in enumerate(elements):
        entries = {field: _unboxed(element[field]) for field in fields}
        _structure(path if len(elements) == 1 else f"{path}({k + 1})", path, entries, gathered, levels)


def _unboxed(value: Any) -> Any:
    """A field's value, which SciPy wraps in an array of one object for a single structure."""
    return value.item() if isinstance(value, np.ndarray) and value.dtype.kind == "O" and value.ndim == 0 else value


def _structure(path: str, parent: str, entries: Mapping[str, Any], gathered: _Gathered, levels: int) -> None:
    """A structure's fields; a structure with a name and data is a signal, which gives a column of that name."""
    label = next((str(entries[key]) for key in _LABELS if isinstance(entries.get(key), str) and entries[key]), None)
    data = next((key for key in _VALUES if isinstance(entries.get(key), np.ndarray)), None)
    if label is not None and data is not None:
        name = f"{parent}.{label}"
        gathered.add(name, entries[data])
        unit = next((entries[key] for key in ("Unit", "unit", "Units") if isinstance(entries.get(key), str)), "")
        if unit:
            gathered.units[name] = unit
        return
    for key, value in entries.items():
        _walk_5(f"{path}.{key}", value, gathered, levels - 1)


def _version_73(path: Path, gathered: _Gathered) -> None:
    h5py = required("h5py", path, "MAT files of version 7.3")
    with h5py.File(path, "r") as file:
        for name, item in _own_items(h5py, file):
            if name not in ("#refs#", "#subsystem#"):
                _walk_73(h5py, name, item, gathered, DEEPEST)


def _own_items(h5py: Any, group: Any) -> Iterator[tuple[str, Any]]:
    """The items that a group itself contains: links could lead to other files of this machine."""
    for name in group:
        if isinstance(group.get(name, getlink=True), h5py.HardLink):
            yield str(name), group[name]


def _walk_73(h5py: Any, path: str, item: Any, gathered: _Gathered, levels: int) -> None:
    gathered.element()
    if not levels:
        return
    if isinstance(item, h5py.Group):
        entries = {name: _value_73(h5py, member, gathered) for name, member in _own_items(h5py, item)}
        if all(isinstance(entry, list) for entry in entries.values()) and entries:
            elements = [dict(zip(entries, row, strict=True)) for row in zip(*entries.values(), strict=False)]
            for k, element in enumerate(elements):
                values = {name: _value_73(h5py, entry, gathered) for name, entry in element.items()}
                _structure_73(h5py, f"{path}({k + 1})", path, values, gathered, levels)
        else:
            _structure_73(h5py, path, path, entries, gathered, levels)
        return
    value = _value_73(h5py, item, gathered)
    if isinstance(value, list):
        gathered.texts(path, [_value_73(h5py, cell, gathered) for cell in value])
        for k, cell in enumerate(value):
            _walk_73(h5py, f"{path}{{{k}}}", cell, gathered, levels - 1)
    elif isinstance(value, np.ndarray):
        gathered.add(path, value)


def _structure_73(
    h5py: Any, path: str, parent: str, entries: Mapping[str, Any], gathered: _Gathered, levels: int
) -> None:
    label = next((entries[key] for key in _LABELS if isinstance(entries.get(key), str) and entries[key]), None)
    data = next((key for key in _VALUES if isinstance(entries.get(key), np.ndarray)), None)
    if label is not None and data is not None:
        _structure(path, parent, entries, gathered, levels)
        return
    for key, value in entries.items():
        if isinstance(value, np.ndarray):
            gathered.add(f"{path}.{key}", value)
        elif isinstance(value, list):
            for k, cell in enumerate(value):
                _walk_73(h5py, f"{path}.{key}{{{k}}}", cell, gathered, levels - 1)
        elif isinstance(value, h5py.Group):
            _walk_73(h5py, f"{path}.{key}", value, gathered, levels - 1)


def _value_73(h5py: Any, item: Any, gathered: _Gathered) -> Any:
    """A data set's text, numbers, or the items that it refers to as a list; a group as it is."""
    if not isinstance(item, h5py.Dataset):
        return item
    # External and virtual data are not part of the file.
    if item.external or item.is_virtual or "MATLAB_empty" in item.attrs:
        return None
    gathered.count(item.shape or ())
    if item.dtype == h5py.ref_dtype:
        for _ in range(item.size):
            gathered.element()
        return [item.file[reference] for reference in np.ravel(item[()]) if reference]
    if item.attrs.get("MATLAB_class") in (b"char", "char"):
        return "".join(map(chr, np.ravel(item[()]).tolist()[:1000]))
    return item[()] if item.dtype.kind in "biuf" else None
