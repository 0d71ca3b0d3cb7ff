"""The one error that a user of the exam can cause. Its message is one line: what is wrong, where, and the remedy."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

LONGEST = 1000
"""Characters of a message; what a tool wrote may be of any length."""


class ExamError(Exception):
    """Anything that the user can put right."""

    def __init__(self, message: object = "") -> None:
        super().__init__(printable(str(message)))


def printable(text: str) -> str:
    """The text as one line in which a terminal finds no control characters: files may hold any."""
    line = " ".join(text.split())
    shown = "".join(char if char.isprintable() else char.encode("unicode_escape").decode() for char in line[:LONGEST])
    return shown if len(line) <= LONGEST else f"{shown} ..."


def remedy(wrong: str, known: Iterable[str]) -> str:
    """What to do about an unknown name: take the nearest one that is known, else any of them."""
    names = list(known)
    near = get_close_matches(wrong, names, n=1)
    return f"did you mean {near[0]}?" if near else f"choose {', '.join(names)}"
