"""The truth sample by sample, for a rig whose command comes while it runs."""

from __future__ import annotations

import numpy as np
import pytest

from eha_exam.truth import SteppedTruth, simulate_truth
from eha_exam.truth.simulate import COLUMNS

EFFECTS = (
    ("coulomb_friction", {"force": 150.0}),
    ("command_delay", {"delay": 3e-3}),
    ("position_sensor_scale", {"ratio": 0.05}),
)


def test_sample_by_sample_it_is_the_whole_run() -> None:
    rate, samples = 500.0, 400
    voltage = 0.05 * np.sin(2.0 * np.pi * 2.0 * np.arange(samples) / rate)
    whole = simulate_truth({}, EFFECTS, voltage, (samples - 1) / rate, rate)
    stepped = SteppedTruth({}, EFFECTS, rate)
    for k, volts in enumerate(voltage):
        position, velocity, pressure_a, pressure_b = stepped.sense()
        assert (position, velocity) == (whole["measured_position"][k], whole["velocity"][k])
        assert (pressure_a, pressure_b) == (whole["measured_pressure_a"][k], whole["measured_pressure_b"][k])
        assert stepped.hold(volts) == pytest.approx([whole[name][k] for name in COLUMNS], rel=0, abs=0)
