"""Measured dampers beside the project, which are not part of it: tests that need them are skipped without them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eha_core.motion_given import Motion, motion_of
from eha_core.recording import Recording

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
CURRENTS = {"0A": 0.0, "0x25A": 0.25, "0x5A": 0.5, "0x75A": 0.75, "1A": 1.0}
TESTS = ("10mm1Hz", "25mm0x5Hz", "5mm3Hz")

needs_dampers = pytest.mark.skipif(
    not ((DATA / "mr_damper").is_dir() and (DATA / "mr_damper_raw").is_dir()), reason="no recordings beside the project"
)


def processed(test: str, current: str) -> Motion:
    """A file whose authors averaged displacement and force over 0.100 of the period."""
    time, position, force = np.loadtxt(DATA / "mr_damper" / f"{test}{current}.txt", usecols=(0, 1, 3)).T
    return _motion(time - time[0], 1e-3 * position, force, CURRENTS[current], f"{test}{current}")


def raw(current: int) -> Motion:
    """A spell of the logger's own file at 25 mm and 0.25 Hz, not averaged: 0 for 0 A, 4 for 1 A."""
    path = DATA / "mr_damper_raw" / f"raw_ME25mm0x25Hz_{current}.csv"
    time, position, force = np.loadtxt(path, delimiter=",", skiprows=1).T
    return _motion(time, 1e-3 * position, force, current / 4.0, path.stem)


def raw_at_5_hz() -> Motion:
    """The head of the logger's file at 2 mm and 5 Hz, of which the last line is cut off."""
    lines = (DATA / "mr_damper_raw" / "ME2mm5Hz_head.txt").read_text().splitlines()[7:-1]
    force, position = np.array([[float(word) for word in line.split(",")[2:4]] for line in lines]).T
    return _motion(np.arange(len(force)) / 200.0, 1e-2 * position, 980.665 * force, 0.0, "ME2mm5Hz")


def _motion(time: np.ndarray, position: np.ndarray, force: np.ndarray, schedule: float, name: str) -> Motion:
    coil = np.full(len(time), schedule)
    return motion_of(Recording.from_arrays(time=time, position=position, force=force, schedule=coil, name=name))
