"""Cells of text as times: dates in every order, clocks of 12 and 24 hours, by one pattern and pandas."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

DAY = 86_400_000_000_000
"""ns."""
_MONTHS = (
    "jan feb mar apr may jun jul aug sep oct nov dec", "jan feb m\u00e4r apr mai jun jul aug sep okt nov dez",
)  # fmt: skip
_NAMED = {name: str(k + 1) for row in _MONTHS for k, name in enumerate(row.split())} | {"mrz": "3"}
_MONTH = r"(?P<month>[A-Za-z\u00e4]{3,9})\.?"
_DATES = (
    r"(?P<iso>\d{4}[-/.]\d{1,2}[-/.]\d{1,2})",
    r"(?P<first>\d{1,2})(?P<mark>[-/.])(?P<second>\d{1,2})(?P=mark)(?P<year>\d{4}|\d{2})",
    rf"(?:[A-Za-z]{{2,10}},?\s+)?(?P<day>\d{{1,2}})[-. ]+{_MONTH}[-. ,]+(?P<named>\d{{4}}|\d{{2}})",
    rf"(?:[A-Za-z]{{2,10}},?\s+)?{_MONTH}[- ]+(?P<day>\d{{1,2}}),?[- ]+(?P<named>\d{{4}})",
)
"""2026-05-04, 4/5/2026 or 04.05.26, 4 May 2026, May 4, 2026."""
_CLOCK = (
    r"(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<seconds>\d{2}(?:[.,:]\d{1,9})?))?"
    r"(?:\s*(?P<half>[AaPp]\.?[Mm]\.?))?\s*(?P<zone>Z|z|UTC|GMT|[-+]\d{2}:?\d{2})?"
)
_SHORT_CLOCK = r"(?P<minute>\d{1,2}):(?P<seconds>\d{2}[.,]\d{1,9})"
"""A clock as spreadsheets shorten it: minutes and seconds, as 04:52.3."""
_FORMS = tuple(re.compile(form) for date in _DATES for form in (rf"{date}(?:[T ,;_-]\s*|\s+){_CLOCK}", date)) + (
    re.compile(_CLOCK),
    re.compile(_SHORT_CLOCK),
)


@dataclass(frozen=True)
class Instants:
    """Texts as times.

    Attributes:
        stamps: ns since 1970 in the zone that they name; of clocks without a date, since midnight.
        known: flags of the texts with a time.
        other: the stamps with day and month swapped, where both orders fit all dates; else None.
        has_date, has_clock: the parts of the texts.
        month_first: whether a date shows that the month is before the day.
    """

    stamps: NDArray[np.int64]
    known: NDArray[np.bool_]
    other: NDArray[np.int64] | None
    has_date: bool
    has_clock: bool
    month_first: bool = False


def is_instant(cell: str) -> bool:
    """Whether a cell has a date, a clock or both."""
    return _match(cell) is not None


def _match(cell: str) -> re.Match[str] | None:
    text = cell.strip()
    if not any(character in text for character in ":-/.") or len(text) > 60:
        return None
    for form in _FORMS:
        if (match := form.fullmatch(text)) and _stands(match.groupdict()):
            return match
    return None


def _stands(found: dict[str, str | None]) -> bool:
    """Whether the numbers of a match can be a date and a clock."""
    if found.get("month") and str(found["month"]).lower()[:3] not in _NAMED:
        return False
    numbers = [int(str(found[name])) for name in ("first", "second") if found.get(name)]
    if numbers and (max(numbers) > 31 or min(numbers) > 12 or min(numbers) < 1):
        return False
    # A number such as 12.05.26 without a clock is not a date; neither is hh:mm alone.
    return (
        "hour" not in found
        or found["seconds"] is not None
        or found["half"] is not None
        or "iso" in found
        or bool(numbers)
    )


def instants_of(cells: NDArray[Any]) -> Instants:
    """An array of texts as times, in the form of the first that is one; others are not known."""
    texts = np.array([cell.strip() if isinstance(cell, str) else "" for cell in cells], dtype=object)
    match = next((one for text in texts if (one := _match(text))), None)
    if match is None:
        return Instants(np.zeros(len(texts), np.int64), np.zeros(len(texts), bool), None, False, False)
    found = match.groupdict()
    has_date = any(found.get(name) for name in ("iso", "first", "month"))
    has_clock = bool(found.get("minute"))
    if found.get("first"):
        day_first = _order(texts, match)
        stamps, known = _parsed(texts, match, day_first is not False)
        other = _parsed(texts, match, False)[0] if day_first is None else None
        return Instants(stamps, known, other, True, has_clock, day_first is False)
    stamps, known = _parsed(texts, match, True)
    return Instants(stamps, known, None, has_date, has_clock)


def _order(texts: NDArray[Any], match: re.Match[str]) -> bool | None:
    """Whether the day is before the month; None where the dates are ambiguous."""
    if match["mark"] == ".":
        return True
    pairs = {
        tuple(re.split(r"[-/]", text, maxsplit=2)[:2]) for text in set(texts[:: max(1, len(texts) // 1000)]) if text
    }
    numbers = [
        (int(one), int(two))
        for one, two in (pair for pair in pairs if len(pair) == 2)
        if one.isdigit() and two.isdigit()
    ]
    if any(one > 12 for one, _ in numbers):
        return True
    return False if any(two > 12 for _, two in numbers) else None


def _parsed(texts: NDArray[Any], match: re.Match[str], day_first: bool) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """The texts read by pandas in the form of the matched one; those in another form one by one."""
    import pandas

    written = _form(match, day_first)
    if written is None:
        return _one_by_one(texts, np.zeros(len(texts), np.int64), np.zeros(len(texts), bool), day_first)
    form, prefix, swaps = written
    given = texts
    for old, new in swaps:
        given = np.array([text.replace(old, new) for text in given], dtype=object)
    if prefix:
        given = prefix + given
    parsed = pandas.to_datetime(pandas.Series(given), format=form, errors="coerce", utc=True).dt.tz_localize(None)
    known = parsed.notna().to_numpy()
    stamps = parsed.to_numpy().astype("datetime64[ns]").astype(np.int64)
    return _one_by_one(texts, np.where(known, stamps, 0), known, day_first)


def _one_by_one(
    texts: NDArray[Any], stamps: NDArray[np.int64], known: NDArray[np.bool_], day_first: bool
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Fill in the texts that are not known yet."""
    for k in np.flatnonzero(~known):
        if texts[k] and (again := _match(texts[k])) is not None and (stamp := _one(again, day_first)) is not None:
            stamps[k], known[k] = stamp, True
    return stamps, known


def _form(match: re.Match[str], day_first: bool) -> tuple[str, str, list[tuple[str, str]]] | None:
    """The form of a text in pandas' notation, its prefix, and the replacements in it; None without a form."""
    found, text = match.groupdict(), match.string
    usual = (
        not found.get("month") and not found.get("zone") and found.get("seconds") and ":" not in str(found["seconds"])
    )
    if not usual or re.search(r"\s{2,}", text) or not re.fullmatch(r"[\d/.:,TAPMapm -]+", text):
        is_iso = re.match(r"\d{4}-\d\d-\d\d(?:[T ]\d\d:|$)", text) and not found.get("half") and "," not in text
        return ("ISO8601", "", []) if is_iso else None
    swaps = [(",", ".")] if "," in str(found["seconds"]) else []
    seconds = "%S.%f" if len(str(found["seconds"])) > 2 else "%S"
    clock = f"{'%I' if found.get('half') else '%H'}:%M:{seconds}" if found.get("hour") else f"%M:{seconds}"
    if found.get("half"):
        clock += (" " if re.search(r"\s[AaPp][Mm]$", text) else "") + "%p"
    if found.get("iso"):
        mark = str(found["iso"])[4]
        date = f"%Y{mark}%m{mark}%d"
    elif found.get("first"):
        mark = str(found["mark"])
        order = ("%d", "%m") if day_first else ("%m", "%d")
        date = mark.join((*order, "%Y" if len(str(found["year"])) == 4 else "%y"))
    else:
        return f"%Y-%m-%d {clock}", "1970-01-01 ", swaps
    length = match.end("iso") if found.get("iso") else match.end("year")
    return f"{date}{text[length]}{clock}", "", swaps


def _one(match: re.Match[str], day_first: bool) -> int | None:
    """The time of one text [ns]; None for a day or a clock that does not exist."""
    found = match.groupdict()
    year, month, day = _date(found, day_first)
    seconds, _, fraction = re.sub(r"[,:]", ".", str(found.get("seconds") or "0")).partition(".")
    hour = int(found.get("hour") or 0)
    if half := found.get("half"):
        hour = hour % 12 + (12 if half[0] in "pP" else 0)
    try:
        date = np.datetime64(f"{year:04d}-{month:02d}-{day:02d}", "ns").astype(np.int64)
    except ValueError:
        return None
    if hour > 24 or int(found.get("minute") or 0) > 59 or int(seconds) > 60:
        return None
    clock = (hour * 60 + int(found.get("minute") or 0)) * 60 + int(seconds)
    zone = str(found.get("zone") or "")
    minutes = (60 * int(zone[1:3]) + int(zone[-2:])) * (-1 if zone[0] == "-" else 1) if zone[:1] in ("+", "-") else 0
    return int(date) + (clock - 60 * minutes) * 10**9 + int(fraction[:9].ljust(9, "0"))


def _date(found: dict[str, str | None], day_first: bool) -> tuple[int, int, int]:
    if found.get("iso"):
        year, month, day = (int(part) for part in re.split(r"[-/.]", str(found["iso"])))
        return year, month, day
    if found.get("first"):
        one, two, year = int(str(found["first"])), int(str(found["second"])), int(str(found["year"]))
        return year + (2000 if year < 100 else 0), *((two, one) if day_first else (one, two))
    if found.get("month"):
        year = int(str(found["named"]))
        month = int(_NAMED[str(found["month"]).lower()[:3]])
        return year + (2000 if year < 100 else 0), month, int(str(found["day"]))
    return 1970, 1, 1
