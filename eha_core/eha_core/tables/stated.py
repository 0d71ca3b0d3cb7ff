"""Statements in a file's text: the unit in a name, the rate in the lines above the numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable
from math import isfinite

from eha_core.unit_names import unit_named

MOST_RATE = 1e6
"""Hz; a higher stated rate is a damaged header, or another rate."""
_BRACKETS = re.compile(r"[\[(<{]([^\[\]()<>{}]*(?:\([^()]*\))?)[\])>}]")
_NUMBER = r"(?P<number>\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?)"
_BETWEEN = r"\s*(?:[\[(](?P<stated>[^\])]{1,12})[\])])?\s*[\"']?\s*[:=,;\t ]\s*[\"']?\s*"
_BEHIND = r"[\s\"',;]*(?P<unit>[A-Za-z\u00b5\u03bc/]{0,12})[\"',;\s]*"
_WHAT = (
    r"(?:sampl\w*|abtast\w*|scan\w*|acqui\w*|acq|logg\w*|record\w*|mess\w*|daq|data|time|update|frame|storage|raster)"
)
_RATE = re.compile(
    rf"[#%*\s\"']*(?:{_WHAT}[ _-]*)*(?:rate|frequency|freq|frequenz|fs|f_s|samplerate|abtastrate|messrate|hz)(?:\s*hz)?"
    rf"{_BETWEEN}{_NUMBER}{_BEHIND}", re.IGNORECASE,
)  # fmt: skip
_INTERVAL = re.compile(
    rf"[#%*\s\"']*(?:{_WHAT}[ _-]*)*(?:interval|intervall|period|periode|step|delta|delta[ _]?[xt]|dt|ts|increment"
    rf"|abstand|abtastzeit|sampletime|zykluszeit|cycle ?time|sample ?time){_BETWEEN}{_NUMBER}{_BEHIND}", re.IGNORECASE,
)  # fmt: skip
_HERTZ = {
    "": 1.0,
    "hz": 1.0,
    "khz": 1e3,
    "mhz": 1e6,
    "s/s": 1.0,
    "ks/s": 1e3,
    "sps": 1.0,
    "ksps": 1e3,
    "samples/s": 1.0,
    "sa/s": 1.0,
}


def unit_in(name: str) -> str:
    """The unit that a name states in brackets, as in `p_A [bar]` or `Command (V) - Plot 0`; empty without one.

    Only known units count: `In1 (1)` and `X[0]` are numbered. In square brackets at the end of a name, an unknown unit
    counts, too.
    """
    found = list(_BRACKETS.finditer(name))
    for match in reversed(found):
        if unit_named(match[1]) is not None:
            return match[1].strip()
    if (
        found
        and found[-1].end() == len(name.rstrip())
        and found[-1][0][0] == "["
        and re.search(r"[^\W\d_]", found[-1][1])
    ):
        return found[-1][1].strip()
    return ""


def rate_in(lines: Iterable[str]) -> float | None:
    """The rate [Hz] that one of the lines states, as a frequency or as an interval; None where none does."""
    for line in lines:
        if (match := _RATE.fullmatch(line.strip())) and (rate := _hertz(match)) is not None:
            return rate
        if (match := _INTERVAL.fullmatch(line.strip())) and (seconds := _seconds(match)) is not None:
            return 1.0 / seconds
    return None


def _number(match: re.Match[str]) -> float:
    return float(match["number"].replace(",", "."))


def _hertz(match: re.Match[str]) -> float | None:
    factor = _HERTZ.get((match["stated"] or match["unit"] or "").lower())
    rate = _number(match) * factor if factor is not None else 0.0
    return rate if isfinite(rate) and 0.0 < rate <= MOST_RATE else None


def _seconds(match: re.Match[str]) -> float | None:
    """The interval [s]; without a stated unit it is in s, if that gives a rate above 1 Hz."""
    stated = (match["stated"] or match["unit"] or "").strip()
    unit = unit_named(stated) if stated else None
    value = _number(match)
    if unit is not None and unit.si == "s":
        seconds = value * unit.scale
    elif not stated and value < 1.0:
        seconds = value
    else:
        return None
    return seconds if isfinite(seconds) and seconds >= 1.0 / MOST_RATE else None
