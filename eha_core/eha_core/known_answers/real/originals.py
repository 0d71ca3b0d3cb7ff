"""The measured rigs' files as their authors published them."""

from __future__ import annotations

from pathlib import Path

from eha_core.errors import EhaError


def original(data: Path, file: str) -> Path:
    """The path of a published file in a rig's folder.

    Raises:
        EhaError: it is not there.
    """
    path = data / file
    if not path.is_file():
        raise EhaError(
            f"{path}: is not there; --real takes the folder that holds {data.name}/ with the published files"
        )
    return path
