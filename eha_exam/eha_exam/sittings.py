"""One exam in several sittings: the marks of tables that cover different cases of one seed, read back to be scored
together. A long exam is divided among machines, or goes on another day, by `--opened` and `--cases`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from eha_exam.errors import ExamError
from eha_exam.scoring import Mark

SCHEMA = "eha.exam/1"
"""What a table says it is."""

SAME = ("seed", "commit")
"""What the sittings of one exam share."""


def read_sittings(paths: Sequence[Path]) -> tuple[dict[str, list[Mark]], dict[str, Any]]:
    """The marks of each tool, by its name, over all tables; and what the sittings share.

    ExamError when a file is no table of an exam, when two are not of one seed and commit, or when a case stands in two.
    """
    tables = [_read(path) for path in paths]
    shared = {name: tables[0]["about"].get(name) for name in SAME}
    marks: dict[str, dict[str, Mark]] = {}
    for path, table in zip(paths, tables, strict=True):
        other = {name: table["about"].get(name) for name in SAME}
        if other != shared:
            raise ExamError(f"{path}: is of {_said(other)}, {paths[0]} of {_said(shared)}; pool sittings of one exam")
        for tool, scored in table["tools"].items():
            taken = marks.setdefault(tool, {})
            for row in scored["marks"]:
                mark = _mark(row)
                if mark.name in taken:
                    raise ExamError(f"{path}: {mark.name} stands in another of these tables too; give each case once")
                taken[mark.name] = mark
    return {tool: list(taken.values()) for tool, taken in marks.items()}, shared


def _read(path: Path) -> dict[str, Any]:
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        table = None
    if not isinstance(table, dict) or table.get("schema") != SCHEMA:
        raise ExamError(f"{path}: is not a table.json that eha exam wrote; give the paths of such files")
    return table


def _mark(row: Mapping[str, Any]) -> Mark:
    """A mark as it was: JSON knows lists alone."""
    values: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in row.items()}
    return Mark(**values)


def _said(about: Mapping[str, Any]) -> str:
    return " and ".join(f"{name} {value}" for name, value in about.items())
