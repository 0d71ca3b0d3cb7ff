"""Cells of text as numbers, in every format of loggers and spreadsheets; unreadable cells are flagged."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_core.unit_names import unit_named

POINT, COMMA = ".", ","
MISSING = frozenset(("", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "---", "nil", "missing", "."))
"""Cells, in small letters, that mean a missing value."""
PREFIXES = {
    "p": 1e-12,
    "n": 1e-9,
    "u": 1e-6,
    "\u00b5": 1e-6,
    "\u03bc": 1e-6,
    "m": 1e-3,
    "k": 1e3,
    "K": 1e3,
    "M": 1e6,
    "G": 1e9,
}
"""Letters that instruments write after a number in place of a power of ten."""
_GROUPS = {POINT: ",'\u2019\u00a0\u202f _", COMMA: ".'\u2019\u00a0\u202f _"}
"""Separators of thousands, by decimal point."""
_INFINITE = re.compile(r"[-+]?inf(?:inity)?", re.IGNORECASE)
_LIKE_A_NUMBER = re.compile(r"[-+\u2212]?[\d.,'\u2019\u00a0\u202f _]*\d[\d.,'\u2019\u00a0\u202f _]*")


@dataclass(frozen=True)
class Cells:
    """Texts as numbers.

    Attributes:
        values: one number for each text; NaN without one.
        unreadable: flags of the texts with something that is not a number.
        units: the different texts after the numbers, "" for none.
    """

    values: NDArray[np.float64]
    unreadable: NDArray[np.bool_]
    units: frozenset[str]


@lru_cache
def _forms(decimal: str) -> re.Pattern[str]:
    """A number with its thousands, its exponent and the text after it."""
    point, group = re.escape(decimal), f"[{re.escape(_GROUPS[decimal])}]"
    plain = rf"\d+(?:{point}\d*)?|{point}\d+"
    grouped = rf"[1-9]\d{{0,2}}(?P<group>{group})\d{{3}}(?:(?P=group)\d{{3}})*(?:{point}\d*)?"
    return re.compile(
        rf"(?P<sign>[-+\u2212]?)\s*(?P<number>{grouped}|{plain})(?P<power>[eEdD][-+]?\d+)?\s*(?P<behind>[^\d\s][^\d]*)?"
    )


def number_of(cell: str, decimal: str, scaled: bool = False) -> tuple[float, str] | None:
    """The number of a cell and the text after it; None without a number.

    With `scaled`, a letter such as k or m after the number is a power of ten.
    """
    text = cell.strip().replace("\u2212", "-")
    match = _forms(decimal).fullmatch(text)
    if match is None:
        return (float(text.lower().replace("infinity", "inf")), "") if _INFINITE.fullmatch(text) else None
    behind = (match["behind"] or "").strip()
    factor = PREFIXES.get(behind) if scaled else None
    if behind and factor is None and unit_named(behind) is None and behind not in PREFIXES:
        return None
    digits = match["number"].replace(match["group"] or "\0", "").replace(decimal, ".")
    power = (match["power"] or "").replace("d", "e").replace("D", "e")
    value = float(f"{'-' if match['sign'] == '-' else ''}{digits}{power}")
    return (value * factor, "") if factor is not None else (value, behind)


def is_number(cell: str, decimal: str = POINT) -> bool:
    """Whether a cell has a finite number."""
    found = number_of(cell, decimal)
    return found is not None and bool(np.isfinite(found[0]))


def is_missing(cell: str) -> bool:
    """Whether a cell means a missing value."""
    return cell.strip().lower() in MISSING


def looks_like_a_number(cell: str) -> bool:
    """Whether a cell consists of digits and their separators, in any order."""
    return _LIKE_A_NUMBER.fullmatch(cell.strip()) is not None


def is_grouped(cell: str, decimal: str) -> bool:
    """Whether the separator in a cell's number may be that of thousands or the decimal point."""
    return re.fullmatch(rf"[-+\u2212]?[1-9]\d{{0,2}}{re.escape(decimal)}\d{{3}}", cell.strip()) is not None


def numbers_of(cells: NDArray[Any], decimal: str, scaled: bool = False) -> Cells:
    """An array of texts, with or without numbers among them, as numbers."""
    values = np.full(len(cells), np.nan)
    unreadable = np.zeros(len(cells), dtype=bool)
    units = set()
    for k, cell in enumerate(cells):
        if not isinstance(cell, str):
            values[k] = np.nan if cell is None else cell
            continue
        found = number_of(cell, decimal, scaled)
        if found is not None:
            values[k] = found[0]
            units.add(found[1])
        else:
            unreadable[k] = not is_missing(cell)
    return Cells(values, unreadable, frozenset(units))
