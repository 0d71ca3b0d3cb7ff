"""A diagnosis of an hour's record, as a user calls it: how long it takes, and how much memory."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

from benchmarks.processes import Used, timed
from benchmarks.row import Row

SECONDS, RATE, FRICTION = 3600, 1000, 150.0
MOST_SECONDS, MOST_BYTES = 300.0, 2e9
RIG = (
    "simulate", "--command", "multisine:amplitude=0.05", "--duration", str(SECONDS), "--rate", str(RATE),
    "--noise", "1", "--seed", "13", "--instruments-only",
    "--set", f"coulomb_friction.force={FRICTION:g}",
)  # fmt: skip
"""The rig: dry friction that the nominal model lacks; what its instruments give and nothing else."""


def measure() -> list[Row]:
    """Make the record, diagnose it in a process of its own, and read the answer."""
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder) / "hour.mcap", Path(folder) / "report"
        _eha(*RIG, "--out", str(path))
        size = path.stat().st_size / 1e6
        used = _eha("diagnose", str(path), "--out", str(out))
        found = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    force = next(effect["parameters"]["force"] for effect in found["effects"] if effect["id"] == "coulomb_friction")
    named = " and ".join(effect["id"] for effect in found["effects"])
    error = (force["value"] - FRICTION) / force["std"]
    return [
        Row(
            f"eha diagnose on {SECONDS} s at {RATE} Hz, four channels, {size:.0f} MB",
            f"{used.seconds:.0f} s, {used.cpu:.0f} s of them CPU time, report included",
            "the wall clock",
            f"{SECONDS / used.seconds:.0f} x real time",
            f"<= {MOST_SECONDS:.0f} s on two idle cores",
            bool(used.seconds <= MOST_SECONDS),
        ),
        Row(
            "the same: memory at most",
            f"{used.memory / 1e9:.2f} GB",
            f"the file's {size / 1e3:.2f} GB",
            f"{used.memory / 1e6 / size:.2f} x the file",
            f"<= {MOST_BYTES / 1e9:g} GB",
            bool(used.memory <= MOST_BYTES),
        ),
        Row(
            f"the same: {FRICTION:g} N of dry friction",
            f"{named}: {force['value']:.2f} N, standard deviation {force['std']:.3f} N",
            f"{FRICTION:g} N, as simulated",
            f"{error:+.1f} standard deviations",
            "within 3",
            bool(named == "coulomb_friction" and abs(error) < 3.0),
        ),
    ]


def _eha(*words: str) -> Used:
    return timed([sys.executable, "-m", "eha_core.cli", *words])
