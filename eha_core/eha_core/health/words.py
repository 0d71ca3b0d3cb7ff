"""Faults in words, for the terminal, the report and errors."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from eha_core.health.fault import Fault

MOST_SPANS = 3
"""Most intervals of one fault that are listed one by one."""


def in_words(faults: Sequence[Fault]) -> tuple[str, ...]:
    """One line for each channel and kind of fault; a hole of several channels is listed once."""
    lines = []
    for (channels, fault), alike in groupby(_together(faults), lambda entry: (entry[0], entry[1].fault)):
        spans = [entry[1] for entry in alike]
        first = spans[0]
        if len(spans) <= MOST_SPANS:
            when = ", ".join(f"from {span.start:.4g} s to {span.end:.4g} s" for span in spans)
        else:
            when = f"{len(spans)} times from {first.start:.4g} s to {spans[-1].end:.4g} s"
        excluded = "" if not first.excludes else " (excluded)"
        seen = first.seen if len(spans) == 1 or fault != "hole" else "no samples"
        lines.append(f"{channels}: {seen}, {when}{excluded}; {first.remedy}")
    return tuple(lines)


def _together(faults: Sequence[Fault]) -> list[tuple[str, Fault]]:
    """Each fault with its channel, or a gap with all channels that have it."""
    grouped: list[tuple[str, Fault]] = []
    holes = [fault for fault in faults if fault.fault == "hole"]
    shared: set[int] = set()
    for fault in faults:
        if id(fault) in shared:
            continue
        alike = [fault]
        if fault.fault == "hole":
            alike += [
                other
                for other in holes
                if other.channel != fault.channel and id(other) not in shared and _same(fault, other)
            ]
            shared |= {id(other) for other in alike}
        grouped.append((", ".join(other.channel for other in alike), fault))
    return grouped


def _same(fault: Fault, other: Fault) -> bool:
    slack = 0.1 * (fault.end - fault.start)
    return abs(fault.start - other.start) < slack and abs(fault.end - other.end) < slack
