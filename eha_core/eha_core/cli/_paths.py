"""Checks of paths before work begins: a diagnosis of an hour must not fail at a folder that cannot be written to."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable
from pathlib import Path

from eha_core.errors import EhaError, RecordingError


def require_recordings(paths: Iterable[Path]) -> None:
    """Raise RecordingError for the first path that does not exist."""
    for path in paths:
        if not path.exists():
            raise RecordingError(f"{path}: there is no such file or folder")


def require_folder(folder: Path, option: str) -> None:
    """Raise EhaError where a folder could not be made or written to."""
    there = folder
    while not there.exists() and there != there.parent:
        there = there.parent
    if not there.is_dir():
        raise _closed(there, errno.ENOTDIR, option)
    if not os.access(there, os.W_OK | os.X_OK):
        raise _closed(there, errno.EACCES, option)


def require_file(path: Path, option: str) -> None:
    """Raise EhaError where a file could not be written."""
    if path.is_dir():
        raise _closed(path, errno.EISDIR, option)
    if not path.parent.is_dir():
        raise _closed(path, errno.ENOTDIR if path.parent.exists() else errno.ENOENT, option)
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise _closed(path, errno.EACCES, option)


def _closed(path: Path, code: int, option: str) -> EhaError:
    return EhaError(f"{path}: cannot be written ({os.strerror(code)}); choose another {option}")


def write_json(path: Path, text: str) -> Path:
    """Write a document to the path of --json. Raises EhaError where that is not possible."""
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise EhaError(f"{path}: cannot be written ({error.strerror}); choose another --json") from error
    return path
