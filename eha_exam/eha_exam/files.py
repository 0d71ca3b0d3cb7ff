"""A case as files: the recording a user would have, and the sealed answer beside it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import yaml

from eha_exam.case import Arrays, Case
from eha_exam.recordings import write_recording


def recording_name(case: Case) -> str:
    """A file name that says nothing of what is concealed."""
    return f"recording-{case.seed:012x}.mcap"


def write_case(case: Case, arrays: Arrays, path: Path, compressed: bool = True) -> None:
    """Write the recording of a case as MCAP, with the nominal parameters the diagnosis is given."""
    write_recording(path, arrays, case.nominal, compressed)


def further_name(name: str, number: int) -> str:
    """The file name of a case's recording of that number, counted from one."""
    return name if number == 1 else name.replace(".mcap", f"-{number}.mcap")


def write_nominal(nominal: Mapping[str, float], path: Path, per_recording: Sequence[str] = ()) -> None:
    """Write a nominal file: the parameters [SI], and the names of those that differ between several recordings."""
    document: dict[str, Any] = {"eha_sim": {"ros__parameters": dict(nominal)}}
    if per_recording:
        document["per_recording"] = list(per_recording)
    path.write_text(yaml.safe_dump(document), encoding="utf-8")


def answer_text(case: Case) -> str:
    """The answer to a case as JSON text."""
    return json.dumps(asdict(case), indent=1)


def read_answer(text: str) -> Case:
    """The case that `answer_text` wrote."""
    fields = json.loads(text)
    fields["effects"] = tuple((name, values) for name, values in fields["effects"])
    fields["windows"] = {name: tuple(span) for name, span in fields["windows"].items()}
    for name in ("channels", "seen", "loads"):
        fields[name] = tuple(fields[name])
    return Case(**fields)


def digest_of(text: str) -> str:
    """SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()
