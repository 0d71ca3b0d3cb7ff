"""Which effects can be distinguished: by the structure of the equations alone, and by their responses beside noise.

The peer is the Fault Diagnosis Toolbox (Frisk, Krysander and Jung, IFAC World Congress 2017). It knows which variables
stand in which equation, and says which faults some residual shows while it does not show another, whatever the form
and size of both. `eha detect` knows the form as well, and asks at the smallest size that is found.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import Any

import numpy as np

import eha_core as eha
from benchmarks.row import Row, skipped
from eha_core.detectability import Certificate
from eha_core.effects import effect

COMMAND, DURATION = "multisine:amplitude=0.12,lowest=0.3,highest=8,count=16,period=20,seed=5", 12.0
PRESSURES = ("pressure_a", "pressure_b")
EQUATIONS = {
    "coil": ("current_rate", "current", "voltage"),
    "spool": ("spool_rate", "spool", "current"),
    "orifice_a": ("flow_a", "spool", "supply_pressure", "return_pressure", "pressure_a"),
    "orifice_b": ("flow_b", "spool", "supply_pressure", "return_pressure", "pressure_b"),
    "supply": ("supply_pressure", "flow_a", "flow_b"),
    "return": ("return_pressure", "flow_a", "flow_b"),
    "chamber_a": ("pressure_a_rate", "flow_a", "speed", "position", "pressure_a", "pressure_b"),
    "chamber_b": ("pressure_b_rate", "flow_b", "speed", "position", "pressure_a", "pressure_b"),
    "force": ("acceleration", "pressure_a", "pressure_b", "speed", "position"),
    "motion": ("position_rate", "speed"),
}
"""The variables of the plant's equations (docs/reproduction.md has them in full)."""
RATES = {
    "current": "current_rate", "spool": "spool_rate", "pressure_a": "pressure_a_rate", "pressure_b": "pressure_b_rate",
    "speed": "acceleration", "position": "position_rate",
}  # fmt: skip
SITES = {
    "command": ("coil",), "spool": ("spool",), "orifice": ("orifice_a", "orifice_b"),
    "chamber": ("chamber_a", "chamber_b"), "force": ("force",),
}  # fmt: skip
"""The equations in which an effect of a site acts, of those for which ELSEWHERE does not say it."""
ELSEWHERE = {
    "supply_pressure_droop": ("supply",),
    "return_back_pressure": ("return",),
    "unequal_piston_area": ("chamber_b", "force"),
    "leakage_onset": ("chamber_a", "chamber_b"),
    "thermal_drift": ("chamber_a", "chamber_b", "force"),
}

TARGET = "more than the peer"
Size = tuple[str, str]
"""An effect and one of its sizes."""


def measure() -> list[Row]:
    """Ask both with position and pressures recorded, and with the position alone."""
    try:
        import faultdiagnosistoolbox as peer
    except ImportError:
        why = "the peer is not installed: pip install faultdiagnosistoolbox==0.12.5"
        return [skipped("pairs of an effect's size and another effect", TARGET, why)]
    return [_row(peer, channels) for channels in (("position", *PRESSURES), ("position",))]


def _row(peer: ModuleType, channels: Sequence[str]) -> Row:
    certificate = eha.detect(COMMAND, duration=DURATION, channels=channels)
    pairs, ours = _by_response(certificate)
    theirs = _by_structure(peer, channels, {size for size, _ in pairs})
    alone = sorted(theirs - ours)
    note = ", ".join(f"{size[0]} from {rival}" for size, rival in alone)
    return Row(
        f"pairs of an effect's size and another effect, of {len(pairs)}, that {' and '.join(channels)} distinguish",
        f"eha detect, at the smallest size found: {len(ours)}",
        f"the Fault Diagnosis Toolbox, from the equations' structure: {len(theirs)}",
        f"both {len(ours & theirs)}, eha detect alone {len(ours - theirs)}, the peer alone {len(alone)}",
        TARGET,
        len(ours) > len(theirs),
        f"the peer alone, so at larger sizes only: {note}" if alone else "",
    )


def _by_response(certificate: Certificate) -> tuple[set[tuple[Size, str]], set[tuple[Size, str]]]:
    """All pairs of a size that is found and another effect, and those in which the other does not explain it."""
    found = [row for row in certificate.effects if row.size is not None]
    others = {row.effect for row in found}
    pairs = {((row.effect, row.parameter), rival) for row in found for rival in others - {row.effect}}
    same = {((row.effect, row.parameter), rival.effect) for row in found for rival in row.confusions}
    return pairs, pairs - same


def _by_structure(peer: ModuleType, channels: Sequence[str], sizes: set[Size]) -> set[tuple[Size, str]]:
    """The pairs in which some residual shows the size and not the other effect, whichever sizes that has."""
    model, faults = _model(peer, channels, sizes)
    every, found = np.arange(model.X.shape[0]), set()
    for rival in {name for name, _ in sizes}:
        own = [place for size, place in faults.items() if size[0] == rival]
        rest = np.setdiff1d(every, own)
        over = set(rest[peer.dmperm.GetDMParts(model.X[rest]).Mp.row].tolist())
        found |= {(size, rival) for size, place in faults.items() if place in over and size[0] != rival}
    return found


def _model(peer: ModuleType, channels: Sequence[str], sizes: set[Size]) -> tuple[Any, Mapping[Size, int]]:
    """The toolbox's model, and the equation by which each size is zero where it is not missing."""
    standing: dict[str, list[str]] = {name: list(variables) for name, variables in EQUATIONS.items()}
    standing |= {f"{name}_sensor": [name, f"{name}_measured"] for name in channels}
    signals = {size: f"{size[0]}_{size[1]}" for size in sorted(sizes)}
    for (name, parameter), signal in signals.items():
        for equation in _equations(name, parameter):
            if equation in standing:
                standing[equation].append(signal)
    relations: list[Any] = list(standing.values())
    relations += [peer.DiffConstraint(rate, variable) for variable, rate in RATES.items()]
    first = len(relations)
    relations += [[signal, f"fault_{signal}"] for signal in signals.values()]
    known = ["voltage", *(f"{name}_measured" for name in channels)]
    unknown = {name for variables in standing.values() for name in variables} | set(RATES) | set(RATES.values())
    made = peer.DiagnosisModel({
        "type": "VarStruc", "x": sorted(unknown - set(known)), "f": [f"fault_{signal}" for signal in signals.values()],
        "z": known, "rels": relations,
    }, name="actuator")  # fmt: skip
    return made, {size: first + place for place, size in enumerate(signals)}


def _equations(name: str, parameter: str) -> tuple[str, ...]:
    """Where a size acts: one that is named after a chamber or its sensor only there."""
    site = effect(name).site
    if site == "sensor":
        sensed = ("position",) if name.startswith("position") else PRESSURES
        where = tuple(f"{channel}_sensor" for channel in sensed)
    else:
        where = ELSEWHERE.get(name) or SITES[site]
    ending = parameter[-2:]
    return tuple(one for one in where if f"{ending}_" in f"{one}_") if ending in ("_a", "_b") else where
