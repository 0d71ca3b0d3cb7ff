"""Recordings that the exam did not make: a measured positioning axis, and the recordings shipped with the project."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import loadmat

from eha_core.errors import EhaError
from eha_core.exam.sitting import Progress, run_tool

Array = NDArray[np.float64]

MOTOR_GAIN = 35.15065
"""N/V of the EMPS drive, as published with its data."""
VISCOUS_ONLY = {"moving_mass": 95.1089, "damping_coefficient": 203.5034, "spring_stiffness": 0.0}
"""The EMPS axis with its dry friction and its offset left out (A. Janot, M. Gautier, M. Brunot, 2019)."""

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


@dataclass(frozen=True)
class Shown:
    """What the diagnosis made of one recording. `source` is "measured" or "simulated"; `note` adds a figure."""

    recording: str
    source: str
    expected: tuple[str, ...]
    verdict: str
    named: tuple[str, ...]
    right: bool
    seconds: float
    note: str = ""


def show_bags(folder: Path, progress: Progress) -> list[Shown]:
    """Diagnose every shipped recording whose concealed cause is known."""
    present = [folder / name for name in BAGS if (folder / name).is_file()]
    if not present:
        raise EhaError(f"--bags {folder}: holds none of {', '.join(BAGS)}")
    shown = []
    for count, path in enumerate(present, 1):
        verdict, effects = BAGS[path.name]
        diagnosis, seconds = _diagnose([str(path.resolve())])
        named = _named(diagnosis)
        said = str(diagnosis.get("verdict", "none"))
        right = said == verdict and set(named) == effects
        shown.append(Shown(path.name, "simulated", tuple(sorted(effects)), said, named, right, seconds))
        progress("shipped recordings", count, len(present))
    return shown


def show_emps(folder: Path, progress: Progress) -> list[Shown]:
    """Diagnose the measured EMPS record from a viscous-only model, and simulate its test record with what was found."""
    training, test = (_load(folder / name) for name in ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"))
    with tempfile.TemporaryDirectory() as scratch:
        place = Path(scratch)
        table = np.column_stack([training["t"], training["force"], training["position"]])
        np.savetxt(place / "emps.csv", table, delimiter=",", header="time,force,position", comments="", fmt="%.9g")
        topics = {"channels": {name: {"column": name} for name in ("force", "position")}}
        (place / "topics.yaml").write_text(json.dumps(topics), encoding="utf-8")
        nominal = {"eha_sim": {"ros__parameters": VISCOUS_ONLY}}
        (place / "nominal.yaml").write_text(json.dumps(nominal), encoding="utf-8")
        words = [str(place / "emps.csv"), "--topics", str(place / "topics.yaml")]
        diagnosis, seconds = _diagnose([*words, "--nominal", str(place / "nominal.yaml")])
    named = _named(diagnosis)
    expected = ("constant_load", "coulomb_friction")
    right = set(named) == set(expected)
    note = ""
    if right:
        law = _law(diagnosis)
        errors = [1e3 * open_loop_error(data, law) for data in (training, test)]
        note = f"open-loop error {errors[0]:.2f} mm on its own record, {errors[1]:.2f} mm on the test record"
    progress("EMPS", 1, 1)
    return [Shown("EMPS", "measured", expected, str(diagnosis.get("verdict", "none")), named, right, seconds, note)]


def _load(path: Path) -> dict[str, Array]:
    if not path.is_file():
        raise EhaError(f"--emps {path.parent}: has no {path.name}; give the folder of the published EMPS data")
    data = loadmat(path)
    return {
        "t": data["t"].ravel().astype(float),
        "position": data["qm"].ravel().astype(float),
        "force": MOTOR_GAIN * data["vir"].ravel().astype(float),
    }


def _diagnose(words: Sequence[str]) -> tuple[Mapping[str, Any], float]:
    command = [sys.executable, "-m", "eha_core.cli", "diagnose", *words, "--json", "{answer}", "--jobs", "1"]
    answer = run_tool(command)
    return answer.diagnosis or {}, answer.seconds


def _named(diagnosis: Mapping[str, Any]) -> tuple[str, ...]:
    return tuple(sorted(str(effect["id"]) for effect in diagnosis.get("effects") or ()))


def _law(diagnosis: Mapping[str, Any]) -> dict[str, float]:
    """Mass [kg], damping [N s/m], dry friction [N] and load [N] of a diagnosis."""
    fitted = {row["name"]: float(row["fitted"]) for row in diagnosis["parameters"]}
    effects = {effect["id"]: effect["parameters"] for effect in diagnosis["effects"]}
    return {
        "mass": fitted.get("moving_mass", VISCOUS_ONLY["moving_mass"]),
        "damping": fitted.get("damping_coefficient", VISCOUS_ONLY["damping_coefficient"]),
        "friction": float(effects["coulomb_friction"]["force"]["value"]),
        "load": float(effects["constant_load"]["force"]["value"]),
    }


def open_loop_error(data: Mapping[str, Array], law: Mapping[str, float]) -> float:
    """RMS error [m] of the position simulated open loop from the measured force; the friction step sticks exactly."""
    period = float(data["t"][1] - data["t"][0])
    position, velocity = float(data["position"][0]), 0.0
    simulated = np.empty_like(data["position"])
    grip = law["friction"] * period / law["mass"]
    for k, force in enumerate(data["force"]):
        simulated[k] = position
        free = velocity + period * (force - law["load"]) / law["mass"]
        slipping = np.sign(free) * max(abs(free) - grip, 0.0)
        velocity = slipping / (1.0 + period * law["damping"] / law["mass"])
        position += period * velocity
    return float(np.sqrt(np.mean((simulated - data["position"]) ** 2)))
