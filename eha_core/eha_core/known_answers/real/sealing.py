"""What the court writes: predictions, before the answer is read, and recordings in a form that can be read again."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import EhaError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sealed:
    """A prediction on disk, and the SHA-256 of its file at the time it was written."""

    path: Path
    digest: str

    @property
    def short(self) -> str:
        """Enough of the hash to compare by eye."""
        return self.digest[:8]

    def open(self) -> Array:
        """The prediction, as it was sealed.

        Raises:
            EhaError: the file has been changed since.
        """
        if _digest(self.path) != self.digest:
            raise EhaError(f"{self.path}: the prediction was changed after it was sealed; run the exam again")
        return np.asarray(np.load(self.path), dtype=np.float64)


def seal(folder: Path, name: str, prediction: Array) -> Sealed:
    """Write a prediction to `folder`/<name>.npy and its hash into `folder`/sealed.txt."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.npy"
    np.save(path, prediction)
    digest = _digest(path)
    with (folder / "sealed.txt").open("a", encoding="utf-8") as stream:
        stream.write(f"{digest}  {path.name}\n")
    return Sealed(path, digest)


def write_csv(path: Path, columns: Mapping[str, Array]) -> None:
    """A recording as `eha diagnose` reads it, so that everybody can ask further: SI, pressures absolute."""
    path.parent.mkdir(parents=True, exist_ok=True)
    table = np.column_stack(list(columns.values()))
    np.savetxt(path, table, delimiter=",", header=",".join(columns), comments="", fmt="%.9g")


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
