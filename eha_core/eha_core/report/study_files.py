"""The files of a study: its JSON document and its figure, in a folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from eha_core.errors import EhaError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_study(folder: Path, name: str, text: str, figure: Figure) -> tuple[Path, ...]:
    """Write `name`.json and `name`.png into a folder, made when missing; return their paths.

    Raises EhaError where the folder cannot be written to.
    """
    paths = folder / f"{name}.json", folder / f"{name}.png"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        paths[0].write_text(text, encoding="utf-8")
        figure.savefig(paths[1], dpi=120)
    except OSError as error:
        raise EhaError(
            f"{error.filename or folder}: cannot be written ({error.strerror}); choose another --out"
        ) from error
    return paths
