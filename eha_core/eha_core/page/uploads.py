"""Takes a file that was dropped on the page: within a ceiling, under a name of its own folder."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from pathlib import Path

from eha_core.errors import EhaError

MOST_BYTES = 2 * 2**30
"""Bytes of a file that is dropped; a larger one is read from its place with `eha open FILE`."""
_LONGEST = 120
"""Characters of a name, of which the file system may need four bytes each."""


class TooLarge(EhaError):
    """What comes is more than is taken."""


def plain_name(given: str) -> str:
    """The name of a file without any folder, in characters that every file system takes.

    Raises:
        EhaError: nothing of a name is left.
    """
    last = re.split(r"[/\\]", given)[-1]
    name = re.sub(r"[^\w.() \-]", "_", last).strip(". ")
    if not name:
        raise EhaError(f"{given[:_LONGEST]!r} is no name of a file")
    stem, dot, ending = name.rpartition(".")
    return name if len(name) <= _LONGEST else f"{stem[: _LONGEST - len(ending) - 1]}{dot}{ending[:_LONGEST]}"[:_LONGEST]


async def receive(parts: AsyncIterator[bytes], path: Path, most: int = MOST_BYTES) -> int:
    """Write what comes into a new file and return its bytes; nothing stays of one that is too large.

    Raises:
        TooLarge: more than `most` bytes come.
        EhaError: the file cannot be written.
    """
    size = 0
    try:
        with path.open("xb") as file:
            async for part in parts:
                size += len(part)
                if size > most:
                    raise too_large(path.name, most)
                file.write(part)
    except OSError as error:
        path.unlink(missing_ok=True)
        raise EhaError(f"{path.name}: cannot be kept ({error.strerror}); make room, or use `eha open FILE`") from error
    except BaseException:
        path.unlink(missing_ok=True)
        raise
    return size


def too_large(name: str, most: int = MOST_BYTES) -> TooLarge:
    """The refusal of a file that is too large."""
    return TooLarge(f"{name}: is larger than {most / 2**30:.3g} GB; `eha open FILE` reads it in its place")
