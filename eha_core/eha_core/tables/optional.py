"""Libraries that only some kinds of file need, loaded when such a file is read."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

from eha_core.errors import RecordingError


def required(module: str, path: Path, what: str) -> Any:
    """The module. Raises RecordingError with the command that installs it where it is missing."""
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise RecordingError(f"{path}: {what} are read by {package}; install it: pip install {package}") from error
