"""Output that the verbs of studies share: a table on the terminal, a document and a figure in a folder."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from eha_core.cli._paths import require_file, require_folder, write_json
from eha_core.errors import EhaError


def check_outputs(arguments: argparse.Namespace, folder: Path) -> None:
    """Raise EhaError where --out (by default `folder`) or --json cannot be written to, before any work is done."""
    if arguments.json is None or arguments.out is not None:
        require_folder(arguments.out or folder, "--out")
    if arguments.json not in (None, "-"):
        require_file(Path(arguments.json), "--json")


def present(
    arguments: argparse.Namespace, folder: Path, table: str, text: str, write: Callable[[Path], tuple[Path, ...]]
) -> int:
    """Print the table, or the document `text` where --json is -, and `write` the files of --json and --out."""
    if arguments.json == "-":
        print(text, end="")
        return 0
    written: tuple[Path, ...] = ()
    if arguments.json is not None:
        written = (write_json(Path(arguments.json), text),)
    if arguments.json is None or arguments.out is not None:
        written += write(arguments.out or folder)
    print(table)
    print(f"\nWritten: {', '.join(map(str, written))}")
    return 0


def units_of(words: list[str], example: str) -> dict[str, str]:
    """The unit of each column, of the arguments of --unit. Raises EhaError for one that is not COLUMN=UNIT."""
    for word in words:
        if "=" not in word:
            raise EhaError(f"--unit {word!r} is not COLUMN=UNIT; write for example --unit {example}")
    return {name: unit for name, _, unit in (word.rpartition("=") for word in words)}
