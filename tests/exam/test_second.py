"""The prescribed test is run on the rig of the case, with its effect and its sensors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eha_exam.drawing import draw_case
from eha_exam.errors import ExamError
from eha_exam.second import prescribed_voltage, second_recording

SINE = {"mode": "voltage", "signal": "sine", "sine.amplitude": 0.05, "sine.frequency": 2.0}


def test_the_prescribed_voltage_is_the_reference_generators() -> None:
    time = np.arange(1001) / 1000.0
    np.testing.assert_allclose(prescribed_voltage(SINE, time), 0.05 * np.sin(4.0 * np.pi * time), atol=1e-12)
    with pytest.raises(ExamError, match="reference of position"):
        prescribed_voltage({**SINE, "mode": "position"}, time)
    with pytest.raises(ExamError, match="warble"):
        prescribed_voltage({"signal": "warble"}, time)


def test_the_rig_of_the_case_answers_with_its_own_effect() -> None:
    plain = replace(draw_case("single", 0, 3), rate=500.0, noise=1.0, jitter=0.0, dropout=0.0, effects=())
    bias = replace(plain, effects=(("pressure_sensor_bias", {"bias_a": 4e5, "bias_b": 0.0}),))
    prescribed = {"statement": "a sine", "reference": SINE}
    without, with_bias = second_recording(plain, prescribed), second_recording(bias, prescribed)
    assert set(with_bias) == set(plain.channels)
    assert with_bias["voltage_command"][0][-1] == 10.0
    lifted = with_bias["pressure_a"][1] - without["pressure_a"][1]
    assert np.mean(lifted) == pytest.approx(4e5, rel=0.02)
    assert np.std(without["position"][1]) > 1e-4


def test_channels_that_the_test_asks_for_are_recorded_too() -> None:
    case = replace(draw_case("position_only", 0, 3), rate=500.0)
    assert set(second_recording(case, {"reference": SINE})) == {"voltage_command", "position"}
    more = second_recording(case, {"reference": SINE, "record": ["pressure_a", "pressure_b"]})
    assert tuple(more) == ("voltage_command", "position", "pressure_a", "pressure_b")
    with pytest.raises(ExamError, match="temperature"):
        second_recording(case, {"reference": SINE, "record": ["temperature"]})
