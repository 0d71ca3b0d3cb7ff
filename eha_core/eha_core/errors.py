"""The errors that a user can cause. Each message is one line: what is wrong, where, and the remedy."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

LONGEST = 1000
"""Characters of a message; names that a file brings along may be of any length."""


def printable(text: str) -> str:
    """The text as one line that a terminal shows and does not obey: what files hold may be escape sequences."""
    line = " ".join(text.split())
    shown = "".join(char if char.isprintable() else char.encode("unicode_escape").decode() for char in line[:LONGEST])
    return shown if len(line) <= LONGEST else f"{shown} ..."


class EhaError(Exception):
    """Anything that the user can put right."""

    def __init__(self, message: object = "") -> None:
        super().__init__(printable(str(message)))


class ParameterError(EhaError):
    """A parameter is unknown, is no number, or lies outside its bounds."""


class RecordingError(EhaError):
    """A recording or a topics file cannot be used."""


def remedy(wrong: str, known: Iterable[str], otherwise: str = "") -> str:
    """What to do about a name that is not known: the nearest one that is, else `otherwise`, else all of them."""
    names = list(known)
    near = get_close_matches(wrong, names, n=1)
    return f"did you mean {near[0]}?" if near else otherwise or f"choose {', '.join(names)}"
