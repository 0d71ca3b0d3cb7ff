"""Recordings with nothing wrong in them, to make faults in."""

from __future__ import annotations

from pathlib import Path

import pytest

from eha_core.recording import Recording, read_recording

BAGS = Path(__file__).resolve().parents[2] / "bags"


@pytest.fixture(scope="session")
def as_modelled() -> Recording:
    """A rig with nothing missing, 12 s at 500 Hz, with a sensor's noise."""
    return read_recording(BAGS / "rig_as_modelled.mcap")


@pytest.fixture(scope="session")
def with_friction() -> Recording:
    """A rig with 250 N of Coulomb friction."""
    return read_recording(BAGS / "rig_coulomb_friction.mcap")
