"""A calibration whose parameters are biased is taken back to its nominal values."""

from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.search.nominal_start import at_nominal_values
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

PLANTED = {"leakage_onset.time": 4.87, "leakage_onset.internal_leakage": 1e-10}


def test_the_nominal_values_are_given_back_to_a_calibration_that_biased_them():
    calibration = calibrate([observe(recorded(PLANTED, duration=8.0))], NominalModel(nominal_values()), 2e-4)
    problem, fitted = calibration.problem, calibration.fitted
    biased = [one.name for one in fitted.free if abs(fitted.values[one.name] - one.reference) > 0.02 * one.slope(1.0)]
    assert biased
    given = at_nominal_values(problem, fitted)
    assert given.free == fitted.free
    assert given.data > fitted.data
    for one in given.free:
        assert given.values[one.name] == one.reference
        assert one.value(float(given.q[[other.name for other in given.free].index(one.name)])) == one.reference
