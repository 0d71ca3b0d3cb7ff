"""The calibration simulates at a step at which its own error does not show."""

import pytest
from made import recorded

from eha_core.diagnosis.calibrate import (
    UNNOTICED,
    at_step,
    calibrate,
    calibrate_finely_enough,
    step_error,
    step_needed,
)
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

LONGEST = 2e-4


def test_a_gentle_recording_is_calibrated_at_the_longest_step():
    calibration = calibrate_finely_enough([observe(recorded({}, duration=4.0))], NominalModel(nominal_values()))
    assert calibration.shooting.step_size == LONGEST


def test_a_violent_recording_is_calibrated_at_a_shorter_one():
    observation = observe(recorded({}, duration=6.0, amplitude=2.0, sine=8.0))
    calibration = calibrate_finely_enough([observation], NominalModel(nominal_values()))
    coarse = calibrate([observation], NominalModel(nominal_values()), LONGEST)
    assert calibration.shooting.step_size < LONGEST
    chosen = calibration.shooting.step_size
    errors = [step_error([observation], at.shooting, at.fitted, at.shooting.step_size) for at in (coarse, calibration)]
    assert errors[0] > 10.0 * errors[1]
    assert step_needed([observation], coarse.shooting, coarse.fitted) == chosen
    finer = at_step([observation], coarse, chosen)
    assert finer.fitted.data == pytest.approx(calibration.fitted.data, rel=2e-3)
    # the shorter step leaves noise alone; the longer one leaves its own error, whatever the parameters do
    assert calibration.fitted.data < 1.03 * calibration.fitted.count
    assert coarse.fitted.data - calibration.fitted.data > UNNOTICED
