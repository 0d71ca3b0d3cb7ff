"""The comparison of single effects, carried to its end by the search over sets."""

import pytest
from made import recorded

from eha_core.diagnosis import diagnose
from eha_core.parameters import nominal_values

PLANTED = {"leakage_onset.time": 4.87, "leakage_onset.internal_leakage": 3e-10}


def test_an_instant_that_led_the_calibration_far_astray_is_found():
    result = diagnose(recorded(PLANTED, duration=8.0), nominal_values())
    assert [effect.id for effect in result.effects] == ["leakage_onset"]
    assert result.explained.complete
    assert result.effects[0].parameters["time"].value == pytest.approx(4.87, abs=0.01)
