"""A hum is taken out of a channel to far below the noise, however fast the channel was sampled."""

from __future__ import annotations

import numpy as np
import pytest

import eha_core as eha
from eha_core.health import examine


@pytest.mark.parametrize("rate", [200.0, 500.0, 1000.0, 2000.0])
def test_what_is_left_of_a_hum_is_small_beside_the_noise(rate: float) -> None:
    """A motion of 20 mm, noise of 10 um at stamps that scatter, and 50.1 Hz of three times the noise."""
    rng = np.random.default_rng(4)
    time = (np.arange(int(12.0 * rate)) + rng.uniform(-0.1, 0.1, int(12.0 * rate))) / rate
    sound = 0.02 * np.sin(2.0 * np.pi * 0.4 * time) + 1e-5 * rng.standard_normal(len(time))
    hum = 3e-5 * np.sin(2.0 * np.pi * 50.1 * time + 1.0)
    health = examine(eha.Recording.from_arrays(time=time, position=sound + hum))
    assert [fault.fault for fault in health.faults] == ["hum"]
    assert np.std(health.values["position"] - sound) < 0.1 * 1e-5
