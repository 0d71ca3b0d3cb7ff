"""The faults of a recording's channels, in words and in figures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.health import Fault, in_words
from eha_core.identification.numbers import Array
from eha_core.report.picture import Spans
from eha_core.report.series import pieces, thinned

Intervals = tuple[tuple[float, float], ...]


def fault_lines(diagnosis: Diagnosis) -> Iterator[str]:
    """One line for each channel and kind of fault; with several recordings, with the recording's number."""
    for number in sorted({number for number, _ in diagnosis.health}):
        for line in in_words([fault for other, fault in diagnosis.health if other == number]):
            yield f"recording {number}: {line}" if diagnosis.together else line


def excluded(diagnosis: Diagnosis, name: str) -> Intervals:
    """The intervals [s] in which a channel of the recording shown was excluded or has a gap, or in which the command
    was lost."""
    paths = [recording.path for recording in diagnosis.together]
    drawn = paths.index(diagnosis.path) + 1 if diagnosis.path in paths else 1
    compared = diagnosis.pictures.after
    spans = sorted(
        fault.span
        for number, fault in diagnosis.health
        if number == drawn and _is_missing(fault) and (fault.channel == name or fault.channel not in compared)
    )
    joined: list[tuple[float, float]] = []
    for start, end in spans:
        if joined and start <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], end))
        else:
            joined.append((start, end))
    return tuple(joined)


def _is_missing(fault: Fault) -> bool:
    return fault.excludes or fault.fault == "hole"


def shaded(spans: Intervals) -> tuple[Spans, ...]:
    """The spans as marks of a panel, if there are any."""
    return (Spans(spans, "excluded: a gap or a fault of the recording"),) if spans else ()


def drawn_line(time: Array, values: Array, spans: Intervals, most: int) -> tuple[Array, Array]:
    """A line of about `most` points that does not cross the excluded intervals."""
    if not spans:
        return thinned(time, values, most)
    edges = [-np.inf, *(edge for span in spans for edge in span), np.inf]
    return pieces(time, values, list(zip(edges[::2], edges[1::2], strict=True)), most)
