"""The recordings that are shipped with the project, diagnosed as a user would: what they conceal is known."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eha_core.errors import EhaError
from eha_exam.exam_folder import Progress
from eha_exam.tool import run_tool

BAGS: dict[str, tuple[str, frozenset[str]]] = {
    "paper_leakage_levels.mcap": ("consistent", frozenset()),
    "rig_as_modelled.mcap": ("consistent", frozenset()),
    "rig_other_parameters.mcap": ("parameters", frozenset()),
    "rig_coulomb_friction.mcap": ("missing_physics", frozenset({"coulomb_friction"})),
    "rig_valve_deadband.mcap": ("missing_physics", frozenset({"valve_deadband"})),
    "rig_leakage_onset.mcap": ("missing_physics", frozenset({"leakage_onset"})),
    "rig_deadband_and_friction.mcap": ("missing_physics", frozenset({"valve_deadband", "coulomb_friction"})),
    "rig_five_effects.mcap": (
        "missing_physics",
        frozenset({"coulomb_friction", "valve_deadband", "supply_pressure_droop", "constant_load", "external_leakage"}),
    ),
    "rig_cut_short.mcap": ("missing_physics", frozenset({"coulomb_friction"})),
}
"""What the shipped recordings conceal: the right verdict and effects. All of them are simulated."""

HEAD = ("recording", "concealed", "verdict", "named", "right", "CPU s")


@dataclass(frozen=True)
class Shown:
    """What the diagnosis made of one recording, in so many CPU seconds."""

    recording: str
    expected: tuple[str, ...]
    verdict: str
    named: tuple[str, ...]
    right: bool
    seconds: float


def show_bags(folder: Path, progress: Progress) -> list[Shown]:
    """Diagnose every shipped recording whose concealed cause is known."""
    present = [folder / name for name in BAGS if (folder / name).is_file()]
    if not present:
        raise EhaError(f"--bags {folder}: holds none of {', '.join(BAGS)}")
    shown = []
    for count, path in enumerate(present, 1):
        verdict, effects = BAGS[path.name]
        diagnosis, seconds = diagnose([str(path.resolve())])
        names = named(diagnosis)
        said = str(diagnosis.get("verdict", "none"))
        right = said == verdict and set(names) == effects
        shown.append(Shown(path.name, tuple(sorted(effects)), said, names, right, seconds))
        progress("shipped recordings", count, len(present))
    return shown


def diagnose(words: Sequence[str]) -> tuple[Mapping[str, Any], float]:
    """The document that `eha diagnose` makes of those arguments, empty where it makes none, and its time [s]."""
    command = [sys.executable, "-m", "eha_core.cli", "diagnose", *words, "--json", "{answer}", "--jobs", "1"]
    answer = run_tool(command)
    return answer.diagnosis or {}, answer.seconds


def named(diagnosis: Mapping[str, Any]) -> tuple[str, ...]:
    """The ids of the effects that a diagnosis names, in alphabetical order."""
    return tuple(sorted(str(effect["id"]) for effect in diagnosis.get("effects") or ()))


def as_markdown(shown: Sequence[Shown]) -> str:
    """A row for each of the project's own recordings."""
    lines = [f"| {' | '.join(HEAD)} |", f"|{'---|' * len(HEAD)}"]
    for result in shown:
        cells = (
            result.recording,
            " + ".join(result.expected) or "nothing",
            result.verdict,
            " + ".join(result.named) or "-",
            "yes" if result.right else "no",
            f"{result.seconds:.1f}",
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, ""])
