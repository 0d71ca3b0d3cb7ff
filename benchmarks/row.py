"""One line of the table that `make bench` prints."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A measured quantity, the peer's measured in the same run, and the target.

    `figure` is what the target speaks of; `met` is None where nothing could be measured, and `note` then says why.
    """

    what: str
    measured: str
    peer: str
    figure: str
    target: str
    met: bool | None
    note: str = ""


def skipped(what: str, target: str, why: str) -> Row:
    """Return the row of a benchmark that cannot run here."""
    return Row(what, "-", "-", "-", target, None, why)


def as_markdown(rows: list[Row]) -> str:
    """Return the table in Markdown."""
    lines = ["| what | measured | peer | figure | target | met |", "|---|---|---|---|---|---|"]
    verdicts = {True: "yes", False: "no", None: "not measured"}
    for row in rows:
        verdict = verdicts[row.met] + (f": {row.note}" if row.note else "")
        lines.append(f"| {row.what} | {row.measured} | {row.peer} | {row.figure} | {row.target} | {verdict} |")
    return "\n".join(lines)
