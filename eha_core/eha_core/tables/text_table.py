"""Reads text tables: CSV with any delimiter and decimal point, with or without a header, and similar files."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from io import StringIO
from itertools import chain, islice
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError
from eha_core.tables.assembled import assembled
from eha_core.tables.gathered_columns import GatheredColumn
from eha_core.tables.table import LARGEST, MOST_CELLS, Table
from eha_core.tables.text_header import SPACES, Header, cells_of
from eha_core.tables.vendor_headers import read_header

HEAD = 2**18
"""Bytes in which the header is sought; that of a measurement system has a few thousand."""
LONGEST_LINE = 2**20
"""Most characters of a line; a thousand columns take 20,000."""
ROWS = 2**16
"""Rows that are converted at once."""


def read_text_table(path: Path) -> Table:
    """Read a text table; cells without a number are NaN, and counted.

    Raises:
        RecordingError: the file is not text, not a table, or too large.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise RecordingError(f"{path}: is larger than {LARGEST / 1e9:.1f} GB; cut it, or convert it to MCAP")
        encoding = encoding_of(path)
        with path.open(encoding=encoding, newline=None, errors="replace") as file:
            lines = _lines(path, file)
            head = list(islice(lines, HEAD // 16))
            if not head:
                raise RecordingError(f"{path}: has no samples; expected a header row and one row for each instant")
            header = read_header(str(path), head[:2000])
            return _table(str(path), header, head, chain(head[header.first :], lines))
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from error


def encoding_of(path: Path) -> str:
    """UTF-8, UTF-16 if it is marked, or the Windows code page in which measurement systems write degrees and micro.

    Raises:
        RecordingError: the file is not text.
    """
    with path.open("rb") as file:
        head = file.read(HEAD)
    is_wide = head[:2] in (b"\xff\xfe", b"\xfe\xff") and head[:64].decode("utf-16", "replace").isascii()
    encoding = "utf-16" if is_wide else "utf-8-sig"
    try:
        text = head.decode(encoding, errors="strict")
    except UnicodeDecodeError as problem:
        # A character that is cut by the head's end is no error.
        cut = len(head) == HEAD and problem.start >= len(head) - 4
        text = head[: problem.start].decode(encoding) if cut else head.decode("cp1252", errors="replace")
        encoding = encoding if cut else "cp1252"
    if any(ord(character) < 32 and character not in "\t\r\n\f" for character in text) or "\ufffd" in text:
        raise RecordingError(f"{path}: not a text file; expected CSV with a header row")
    return encoding


def _lines(path: Path, file: TextIO) -> Iterator[str]:
    """The lines of a file in turn. Raises RecordingError at one that is too long for any table."""
    rest = ""
    while part := file.read(LONGEST_LINE):
        *whole, rest = (rest + part).split("\n")
        if len(rest) > LONGEST_LINE:
            raise RecordingError(f"{path}: has a line of more than {LONGEST_LINE} characters, more than in any table")
        yield from whole
    if rest:
        yield rest


def table_of_lines(where: str, kind: str, lines: Sequence[str], remarks: Sequence[str] = ()) -> Table:
    """The table of lines from another kind of file.

    Raises:
        RecordingError: they have no rows of numbers.
    """
    header = replace(read_header(where, lines[:2000]), kind=kind)
    return _table(where, header, lines[:2000], iter(lines[header.first :]), remarks)


class _Body:
    """Takes the rows of a table, block by block."""

    def __init__(self, path: str, header: Header, names_row: str) -> None:
        self.path, self.header = path, header
        texts = {*header.long.names, header.long.unit} if header.long else set()
        self.columns = [
            GatheredColumn(name, header.decimal, header.units.get(name, ""), k in texts)
            for k, name in enumerate(header.names)
        ]
        self.remarks: list[str] = []
        self.count = 0
        self._names_row = names_row
        self._left_out: tuple[int, str] = (0, "")

    def add(self, block: list[str]) -> bool:
        """Take a block of lines; False where the table ends in it."""
        cells = _cells(block, self.header)
        if self.header.step is not None and len(cells[0]):
            cells[0] = np.full(len(block), np.nan)
        read = [column.read(part) for column, part in zip(self.columns, cells, strict=True)]
        valueless = self._valueless(cells, [values for values, _, _ in read])
        keep = np.ones(len(block), dtype=bool)
        ended = False
        for k in np.flatnonzero(valueless):
            row = [str(part[k]) for part in cells if isinstance(part[k], str) and part[k].strip()]
            if not row or not keep[k]:
                continue
            keep[k] = False
            if block[k].strip() == self._names_row:
                continue
            if len(row) > max(2, len(self.columns) // 2) and not valueless[k + 1 :].all():
                self.remarks.append(f"a second table, from row {self.count + k + 1} on, was left out")
                keep[k:] = False
                ended = True
                break
            self._left_out = (self._left_out[0] + 1, self._left_out[1] or block[k].strip())
        for column, part, (values, unreadable, other) in zip(self.columns, cells, read, strict=True):
            column.add(part[keep], values[keep], unreadable[keep], None if other is None else other[keep])
        self.count += int(np.count_nonzero(keep))
        if self.count * len(self.columns) > MOST_CELLS:
            raise RecordingError(f"{self.path}: has more than {MOST_CELLS} cells; cut it, or convert it to MCAP")
        return not ended

    def _valueless(self, cells: Sequence[NDArray[Any]], values: Sequence[NDArray[Any]]) -> NDArray[np.bool_]:
        """Flags of the rows without a value in any column."""
        found = np.ones(len(values[0]), dtype=bool)
        for column, one in zip(self.columns, values, strict=True):
            if not column.is_text:
                found &= ~np.isfinite(one.astype(np.float64))
        return found if any(part.dtype.kind == "O" for part in cells) else np.zeros(len(found), dtype=bool)

    def table(self, remarks: Sequence[str]) -> Table:
        """The table of all blocks."""
        count, first = self._left_out
        said = [f"{count} lines without a number were left out, the first {first!r}"] if count else []
        return assembled(
            self.path, self.header.kind, self.columns, times=self.header.times, rate=self.header.rate,
            step=self.header.step, long=self.header.long, remarks=(*said, *self.remarks, *remarks),
        )  # fmt: skip


def _table(path: str, header: Header, head: Sequence[str], lines: Iterator[str], remarks: Sequence[str] = ()) -> Table:
    names_row = next((line.strip() for line in reversed(head[: header.first]) if line.strip()), "")
    body = _Body(path, header, names_row)
    rows = (line for line in lines if line.strip() and line[:1] != "#")
    ended = ""
    while block := list(islice(rows, ROWS)):
        if header.skip:
            block, ended = _section(block, header.delimiter)
        elif header.kind == "lvm":
            block, ended = _segment(block)
        if not block or not body.add(block) or ended:
            break
    if not body.count:
        raise RecordingError(f"{path}: has no samples; expected a header row and one row for each instant")
    return body.table((*remarks, ended) if ended else remarks)


def _section(block: list[str], delimiter: str) -> tuple[list[str], str]:
    """The rows of a recorder's first group of traces without their labels, and a remark if another follows."""
    kept: list[str] = []
    for line in block:
        label, _, values = line.partition(delimiter)
        label = label.strip().strip('"')
        if label and label != "trace_values":
            return kept, "further groups of traces, recorded at their own times, were left out"
        if values.strip(delimiter + " \r"):
            kept.append(values)
    return kept, ""


def _segment(block: list[str]) -> tuple[list[str], str]:
    """The rows of a LabVIEW file's first segment, and a remark if another segment follows."""
    for k, line in enumerate(block):
        if line.startswith(("Channels", "***")):
            return block[:k], "further segments, each with a header of its own, were left out"
    return block, ""


def _cells(block: Sequence[str], header: Header) -> list[NDArray[Any]]:
    """The block's columns: numbers where pandas reads all of a column as numbers, else texts."""
    import pandas

    width = len(header.names)
    spaces = header.delimiter == SPACES
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            frame = pandas.read_csv(
                StringIO("\n".join(block)), sep=r"\s+" if spaces else header.delimiter, decimal=header.decimal,
                header=None, names=range(width + 1), index_col=False, keep_default_na=False, na_values=[""],
                skipinitialspace=not spaces, float_precision="round_trip", low_memory=False, skip_blank_lines=False,
            )  # fmt: skip
    except (ValueError, pandas.errors.ParserError, OverflowError):
        return _split(block, header)
    if len(frame) != len(block) or frame[width].notna().any():
        return _split(block, header)
    columns = [frame[k].to_numpy() for k in range(width)]
    return [part if part.dtype.kind in "iufO" else part.astype(object).astype(str).astype(object) for part in columns]


def _split(block: Sequence[str], header: Header) -> list[NDArray[Any]]:
    """The block's columns cell by cell, for rows of different length and quotes without an end."""
    width = len(header.names)
    rows = [cells_of(line, header.delimiter)[:width] for line in block]
    padded = [row + [""] * (width - len(row)) for row in rows]
    return [np.array([row[k] for row in padded], dtype=object) for k in range(width)]
