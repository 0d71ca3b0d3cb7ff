"""Reads workbooks (.xlsx) with openpyxl: the sheet with most rows, like a text table of the same cells."""

from __future__ import annotations

from datetime import date, datetime, time, timedelta
from itertools import chain
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

from eha_core.errors import RecordingError
from eha_core.tables.optional import required
from eha_core.tables.table import LARGEST, MOST_CELLS, Table
from eha_core.tables.text_table import table_of_lines

LARGEST_RATIO = 200
"""Most decompressed bytes per byte of a workbook: sheets of numbers compress to 1/10, of equal cells to 1/100."""
MOST_SHEETS = 50


def read_spreadsheet(path: Path) -> Table:
    """Read the sheet of a workbook that has most rows.

    Raises:
        RecordingError: the file is damaged, of another kind, or too large.
    """
    openpyxl = required("openpyxl", path, "Workbooks (.xlsx)")
    try:
        with ZipFile(path) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
        if size > min(LARGEST, 2**20 + LARGEST_RATIO * path.stat().st_size):
            raise RecordingError(f"{path}: unpacks to more than a workbook of its size may; save it as CSV")
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        sheets = {sheet.title: _lines(path, sheet) for sheet in book.worksheets[:MOST_SHEETS]}
        book.close()
    except RecordingError:
        raise
    except (OSError, BadZipFile) as error:
        raise RecordingError(f"{path}: cannot be read as a workbook ({error})") from error
    except Exception as error:  # the parser may raise anything for damaged XML
        raise RecordingError(f"{path}: cannot be read as a workbook ({error})") from error
    if not sheets:
        raise RecordingError(f"{path}: has no sheet")
    name = max(sheets, key=lambda one: len(sheets[one]))
    others = [one for one, lines in sheets.items() if one != name and len(lines) > 1]
    remarks = (f"of the sheets, {name} was read; {', '.join(others)} left out",) if others else ()
    return table_of_lines(f"{path}, sheet {name}", "xlsx", sheets[name], remarks)


def _lines(path: Path, sheet: Any) -> list[str]:
    """The rows of a sheet as lines of cells between tabs."""
    lines = []
    count = 0
    for row in chain(sheet.iter_rows(values_only=True)):
        cells = [_text(cell) for cell in row]
        count += len(cells)
        if count > MOST_CELLS:
            raise RecordingError(f"{path}: has more than {MOST_CELLS} cells; cut it, or convert it to MCAP")
        while cells and not cells[-1]:
            cells.pop()
        lines.append("\t".join(cells))
    return lines


def _text(cell: Any) -> str:
    if cell is None:
        return ""
    if isinstance(cell, datetime):
        return cell.isoformat(sep=" ", timespec="microseconds")
    if isinstance(cell, date):
        return cell.isoformat()
    if isinstance(cell, time):
        return cell.isoformat(timespec="microseconds")
    if isinstance(cell, timedelta):
        return repr(cell.total_seconds())
    if isinstance(cell, (int, float)):
        return repr(cell)
    return " ".join(str(cell).split()).replace('"', "'")
