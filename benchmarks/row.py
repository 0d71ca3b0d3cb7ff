"""One line of the table that `make bench` prints."""

from __future__ import annotations

from dataclasses import dataclass

VERDICTS = {True: "yes", False: "no", None: "not measured"}


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
    for row in rows:
        verdict = VERDICTS[row.met] + (f": {row.note}" if row.note else "")
        lines.append(f"| {row.what} | {row.measured} | {row.peer} | {row.figure} | {row.target} | {verdict} |")
    return "\n".join(lines)


def from_markdown(text: str) -> list[Row]:
    """Return the rows of a table as above; other lines are passed over."""
    table = [line for line in text.splitlines() if line.startswith("|")]
    met = {verdict: known for known, verdict in VERDICTS.items()}
    rows = []
    for line in table[2:]:
        what, measured, peer, figure, target, last = line.strip("| ").split(" | ")
        verdict, _, note = last.partition(": ")
        rows.append(Row(what, measured, peer, figure, target, met[verdict], note))
    return rows
