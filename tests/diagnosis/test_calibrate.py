"""The step of the simulation at which its own error does not show."""

from made import recorded

from eha_core.diagnosis.calibrate import at_step, calibrate, step_error, step_needed
from eha_core.diagnosis.criteria import ENOUGH
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

LONGEST = 2e-4


def calibrated(observation):
    """The calibration at the longest step, and the step that its model needs."""
    calibration = calibrate([observation], NominalModel(nominal_values()), LONGEST)
    return calibration, step_needed([observation], calibration.shooting, calibration.fitted)


def test_a_gentle_recording_needs_no_shorter_step_than_the_longest():
    assert calibrated(observe(recorded({}, duration=4.0)))[1] == LONGEST


def test_a_violent_recording_needs_a_shorter_one():
    observation = observe(recorded({}, duration=6.0, amplitude=2.0, sine=8.0))
    coarse, chosen = calibrated(observation)
    assert chosen < LONGEST
    finer = at_step([observation], coarse, chosen)
    errors = [step_error([observation], at.shooting, at.fitted, at.shooting.step_size) for at in (coarse, finer)]
    assert errors[0] > 10.0 * errors[1]
    # the shorter step leaves noise alone; the longer one leaves its own error, whatever the parameters do
    assert finer.fitted.data < 1.03 * finer.fitted.count
    assert coarse.fitted.data - finer.fitted.data > ENOUGH
