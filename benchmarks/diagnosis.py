"""A diagnosis of a recording, as a user calls it, beside a sparse regression of the same recording by PySINDy."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

from benchmarks.processes import timed
from benchmarks.row import Row

BAGS = Path(__file__).resolve().parent.parent / "bags"
CASES = {
    "rig_coulomb_friction.mcap": "coulomb_friction",
    "rig_deadband_and_friction.mcap": "coulomb_friction + valve_deadband",
}
"""Recordings of 12 s, and what is missing in them."""

PEER = "sindy_stlsq"


def measure() -> list[Row]:
    """Time both on each recording, each in a process of its own; what each of them answered stands beside."""
    return [_row(name, missing) for name, missing in CASES.items()]


def _row(name: str, missing: str) -> Row:
    path = str(BAGS / name)
    with tempfile.TemporaryDirectory() as folder:
        out, answer = Path(folder) / "report", Path(folder) / "answer.json"
        ours = timed([sys.executable, "-m", "eha_core.cli", "diagnose", path, "--out", str(out)])
        peer = timed([sys.executable, "-m", "eha_exam.peers", PEER, path, str(answer)])
        found, theirs = _named(out / "diagnosis.json"), _named(answer)
    ahead = "the peer is ahead, " if peer.cpu < ours.cpu else ""
    factor = max(peer.cpu, ours.cpu) / min(peer.cpu, ours.cpu)
    return Row(
        f"eha diagnose {name}, in which {missing} is missing; start and report included",
        f"{ours.seconds:.1f} s, {ours.cpu:.1f} s of CPU time: {found}",
        f"PySINDy's STLSQ on the weak form, which names sites and effects and gives no values: {peer.seconds:.1f} s,"
        f" {peer.cpu:.1f} s of CPU time: {theirs}",
        f"{ahead}{factor:.3g} x faster",
        "<= 20 s on two idle cores",
        ours.seconds <= 20.0,
    )


def _named(path: Path) -> str:
    effects = json.loads(path.read_text(encoding="utf-8"))["effects"]
    return " + ".join(sorted(effect["id"] for effect in effects)) or "nothing"
