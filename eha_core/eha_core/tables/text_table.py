"""Reads text tables: CSV of any delimiter and decimal point, with or without a header; LabVIEW, ControlDesk."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from itertools import chain, islice
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError
from eha_core.tables.table import LARGEST, MOST_CELLS, Column, Table, distinct
from eha_core.tables.text_cells import is_date, nanoseconds, number
from eha_core.tables.text_header import SPACES, Header, cells_of, read_header

HEAD = 2**18
"""Bytes from which the header is read; that of a measurement system has a few thousand."""
LONGEST_LINE = 2**20
"""Characters of a line; a thousand columns take 20,000."""
ROWS = 2**14
"""Rows that are turned into numbers at once."""


def read_text_table(path: Path) -> Table:
    """Read a text table; cells that hold no number are NaN.

    Raises:
        RecordingError: the file is no text, no table, or larger than a table that is read at once.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise RecordingError(f"{path}: is larger than {LARGEST / 1e9:.1f} GB; cut it, or convert it to MCAP")
        encoding = _encoding(path)
        with path.open(encoding=encoding, newline=None, errors="replace") as file:
            lines = _lines(path, file)
            head = list(islice(lines, HEAD // 16))
            if not head:
                raise RecordingError(f"{path}: has no samples; expected a header row and one row for each instant")
            header = read_header(str(path), head[:2000])
            return _table(path, header, chain(head[header.first :], lines))
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from error


def _encoding(path: Path) -> str:
    """UTF-8, UTF-16 where it says so, or the Windows code page that measurement systems write degrees and micro in."""
    with path.open("rb") as file:
        head = file.read(HEAD)
    is_wide = head[:2] in (b"\xff\xfe", b"\xfe\xff") and head[:64].decode("utf-16", "replace").isascii()
    encoding = "utf-16" if is_wide else "utf-8-sig"
    try:
        text = head.decode(encoding, errors="strict")
    except UnicodeDecodeError as problem:
        # A character that the head's end cuts in two is no fault.
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
        yield from whole
        if len(rest) > 2 * LONGEST_LINE:
            raise RecordingError(f"{path}: has a line of more than {LONGEST_LINE} characters; expected a table")
    if rest:
        yield rest


def _table(path: Path, header: Header, lines: Iterator[str]) -> Table:
    width = len(header.names)
    blocks: list[NDArray[np.float64]] = []
    dated: dict[int, list[NDArray[np.int64]]] = {}
    rows = (line for line in lines if line.strip() and line[:1] != "#")
    ended = ""
    count = 0
    while block := list(islice(rows, ROWS)):
        if header.skip:
            block, ended = _section(block, header.delimiter)
        elif header.kind == "lvm":
            block, ended = _segment(block)
        numbers = _fast(block, header)
        if numbers is None or dated:
            cells = [cells_of(line, header.delimiter) for line in block]
            if not blocks:
                dated = {k: [] for k in range(width) if _is_dated(cells, k)}
            numbers = _slow(cells, width, header.decimal)
            for k, parts in dated.items():
                column = [row[k] if k < len(row) else "" for row in cells]
                parts.append(nanoseconds(column))
                numbers[:, k] = np.where([is_date(cell) for cell in column], 0.0, np.nan)
        blocks.append(numbers)
        count += len(numbers)
        if count * width > MOST_CELLS:
            raise RecordingError(f"{path}: has more than {MOST_CELLS} cells; cut it, or convert it to MCAP")
        if ended:
            break
    if not blocks or not count:
        raise RecordingError(f"{path}: has no samples; expected a header row and one row for each instant")
    dates = {k: np.concatenate(parts) for k, parts in dated.items()}
    return _made(header, np.concatenate(blocks), dates, (ended,) if ended else ())


def _made(
    header: Header, table: NDArray[np.float64], dates: dict[int, NDArray[np.int64]], left: tuple[str, ...]
) -> Table:
    names, remarks = distinct(header.names)
    units = dict(header.units)
    columns: dict[str, Column] = {}
    if header.step is not None:
        start, spacing = header.step
        table[:, 0] = start + spacing * np.arange(len(table))
    for k, name in enumerate(names):
        values = table[:, k]
        if np.isnan(values).all() and (name == "Comment" or name not in header.names):
            continue
        columns[name] = values
        if k in dates:
            sound = ~np.isnan(values)
            # Every row of a date column without its date has no time, and a recording can use none of its values.
            columns[name] = dates[k] if sound.all() else np.where(sound, dates[k] * 1e-9, np.nan)
            units[name] = "ns" if sound.all() else "s"
    return Table(header.kind, columns, {n: unit for n, unit in units.items() if n in columns}, (*remarks, *left))


def _section(block: list[str], delimiter: str) -> tuple[list[str], str]:
    """The rows of a recorder's first group of traces without their labels, and a remark where another follows."""
    kept: list[str] = []
    for line in block:
        label, _, values = line.partition(delimiter)
        label = label.strip().strip('"')
        if label and label != "trace_values":
            return kept, "further groups of traces, recorded at their own times, were left out"
        kept.append(values)
    return kept, ""


def _segment(block: list[str]) -> tuple[list[str], str]:
    """The rows of a LabVIEW file's first segment, and a remark where another segment follows."""
    for k, line in enumerate(block):
        if line.startswith(("Channels", "***")):
            return block[:k], "further segments, each with a header of its own, were left out"
    return block, ""


def _fast(block: Sequence[str], header: Header) -> NDArray[np.float64] | None:
    """The block as numbers; None where a cell holds none, or rows differ in length."""
    lines: Sequence[str] = block
    if header.step is not None:
        lines = [line.partition(header.delimiter)[2] for line in block]
    if header.decimal == ",":
        lines = [line.replace(",", ".") for line in lines]
    width = len(header.names)
    delimiter = None if header.delimiter == SPACES else header.delimiter
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = np.loadtxt(lines, dtype=np.float64, delimiter=delimiter, comments=None, quotechar='"', ndmin=2)
        except (ValueError, IndexError, TypeError):
            return None
    lead = int(header.step is not None)
    if found.shape[0] != len(block) or not 0 < found.shape[1] <= width - lead:
        return None
    numbers = np.full((len(block), width), np.nan)
    numbers[:, lead : lead + found.shape[1]] = found
    return numbers


def _slow(cells: Sequence[Sequence[str]], width: int, decimal: str) -> NDArray[np.float64]:
    table = np.full((len(cells), width), np.nan)
    for k, row in enumerate(cells):
        for j, cell in enumerate(row[:width]):
            if cell:
                table[k, j] = number(cell.replace(",", ".") if decimal == "," else cell)
    return table


def _is_dated(cells: Sequence[Sequence[str]], k: int) -> bool:
    filled = [row[k] for row in cells[:100] if k < len(row) and row[k]]
    return bool(filled) and sum(map(is_date, filled)) > 0.5 * len(filled)
