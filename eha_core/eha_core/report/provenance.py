"""Where a diagnosis comes from: program, command, model, data and date."""

from __future__ import annotations

import hashlib
import shlex
import sys
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path
from typing import Protocol

from eha_core.diagnosis.result import Diagnosis
from eha_core.version import __version__

FROM_RECORDING = "the parameters that the recording carries, or the catalogue's"
"""The nominal model's origin where no file was given."""

_BLOCK = 1 << 20


class Recorded(Protocol):
    """Something that was read from a path."""

    @property
    def path(self) -> Path:
        """The path that it was read from."""


def with_provenance(
    diagnosis: Diagnosis, recordings: Sequence[Recorded], nominal: object = None, command: str | None = None
) -> Diagnosis:
    """The diagnosis with its origin: version, command, nominal model, SHA-256 of each recording, and now."""
    name = Path(sys.argv[0]).name
    typed = shlex.join(["eha" if name == "__main__.py" else name, *sys.argv[1:]])
    provenance = {
        "version": f"eha_core {__version__}",
        "command": command or typed,
        "nominal": FROM_RECORDING if nominal is None else str(nominal),
        "recording_sha256": ", ".join(_digest(recording.path) for recording in recordings),
        "made": datetime.now(timezone.utc).isoformat(timespec="seconds"),
    }
    return replace(diagnosis, provenance=provenance)


def _digest(path: Path) -> str:
    """SHA-256 of a file, or of a folder's files in their order; "-" where there is none."""
    files = sorted(file for file in path.rglob("*") if file.is_file()) if path.is_dir() else [path]
    digest = hashlib.sha256()
    try:
        for file in files:
            with file.open("rb") as stream:
                while block := stream.read(_BLOCK):
                    digest.update(block)
    except OSError:
        return "-"
    return digest.hexdigest()
