"""The clocks of command and position: a steady drift between them is found, and nothing else is called one."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from eha_core.health.clock import drift, steady
from eha_core.recording import Recording

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from tools.hostile.wrong_recordings import as_recording

TIME = np.arange(7000) / 500.0


def speed_at(time: np.ndarray) -> np.ndarray:
    """A random signal of up to 2 Hz, and for a while a sine of 5 Hz, of which a piece fits at many delays."""
    rng = np.random.default_rng(3)
    signal = sum(np.sin(2.0 * np.pi * f * time + rng.uniform(0.0, 6.3)) for f in np.arange(0.13, 2.0, 0.17))
    even = (time > 6.0) & (time < 10.5)
    return np.where(even, 3.0 * np.sin(2.0 * np.pi * 5.0 * time), signal)


def recording_with(clock: float) -> Recording:
    """The position's clock runs so much fast against the command's, and it follows by 20 ms."""
    position = np.cumsum(speed_at(TIME - 0.02)) / 500.0
    return as_recording({"voltage_command": (TIME, speed_at(TIME)), "position": (TIME * (1.0 + clock), position)})


@pytest.mark.parametrize("clock", [0.02, -0.02])
def test_a_drift_is_found_though_pieces_of_even_oscillation_fit_at_other_delays(clock: float) -> None:
    (fault,) = drift(recording_with(clock))
    assert fault.channel == "position" and fault.fault == "clock"
    percent, way = re.search(r"clock runs (\S+) % (\w+)", fault.seen).groups()
    assert float(percent) == pytest.approx(2.0, rel=0.06) and way == ("fast" if clock > 0.0 else "slow")


def test_one_clock_has_no_drift() -> None:
    assert not drift(recording_with(0.0))


@pytest.mark.parametrize(
    ("changes", "rate"),
    [
        ([0.0, 20.0, 40.0, 60.0, 80.0, 100.0], 0.02),
        ([0.0, -17.0, -41.0, 140.0, -79.0, -101.0], -0.02),
        ([0.0, 10.0, 20.0, 30.0, 40.0, 50.0], None),  # as a rig's own does while its test grows faster
        ([7.0, 6.0, 5.0, -155.0, -155.0, -154.0], None),
        ([0.0, 60.0, 10.0, 80.0, 40.0, 100.0], None),
        ([0.0, 25.0, 50.0, 75.0], None),
    ],
)
def test_only_delays_that_change_much_and_at_a_steady_rate_are_a_clocks(changes: list[float], rate: float) -> None:
    """Delays [ms] of pieces a second apart."""
    found = steady(np.arange(len(changes)) + 1.0, 1e-3 * np.array(changes) + 0.02)
    assert (found is None) if rate is None else found[0] == pytest.approx(rate, rel=0.05)
