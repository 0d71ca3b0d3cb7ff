"""A law that is in no catalogue, beside effects that are."""

import numpy as np
import pytest
from made import recorded

from eha_core.curve import KNOTS
from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.comparison import Entry, ModelComparison, rank, residual_variance
from eha_core.diagnosis.unknown import recover
from eha_core.effects import effects
from eha_core.identification.fit import fit
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

LAWS = {effect.id: effect for effect in effects()}
REACH, PITCH, FORCE, HALF_WIDTH = 0.03, 0.02, 300.0, 1.5e-4
PLACES = np.linspace(-REACH, REACH, KNOTS)
RIPPLE = {f"recovered_force.knot_{k:02d}": FORCE * np.sin(2.0 * np.pi * PLACES[k] / PITCH) for k in range(KNOTS)}
PLANTED = {
    "spool_hysteresis.half_width": HALF_WIDTH,
    "recovered_force.variable": 0.0,  # over position
    "recovered_force.lower": -REACH,
    "recovered_force.upper": REACH,
    **RIPPLE,
}


@pytest.fixture(scope="module")
def found():
    """What is recovered where the search left a set of the hysteresis and a load that is not there."""
    observation = observe(recorded(PLANTED, duration=6.0))
    calibration = calibrate([observation], NominalModel(nominal_values()), 2e-4)
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    chosen = [LAWS["constant_load"], LAWS["spool_hysteresis"]]
    begun = {**nominal_values(), "spool_hysteresis.half_width": 1.4e-4, "constant_load.force": 50.0}
    free = with_effects(calibration.fitted.free, chosen, begun)
    fits = {NOTHING.with_effects(chosen): fit(calibration.problem, begun, free, iterations=15)}
    nominal, variance = calibration.fitted, residual_variance([calibration.fitted, *fits.values()])
    comparison = ModelComparison(Entry(NOTHING, nominal, 0.0), rank(nominal, fits), variance)
    return recover(calibration.problem, comparison, scales)


def test_the_law_stands_beside_the_effect_that_is_there_and_takes_the_place_of_the_one_that_is_not(found):
    assert found.hypothesis.ids == ("recovered_force", "spool_hysteresis")
    assert (found.hypothesis.law.id, found.hypothesis.law.variable) == ("recovered_force", "position")
    assert [effect.id for effect in found.named] == ["spool_hysteresis"]


def test_the_effect_and_the_law_have_the_values_that_were_planted(found):
    assert found.fit.values["spool_hysteresis.half_width"] == pytest.approx(HALF_WIDTH, rel=5e-3)
    places, heights = np.array(found.knots).T
    true = np.interp(places, PLACES, list(RIPPLE.values()))
    assert np.sqrt(np.mean((heights - heights.mean() - true + true.mean()) ** 2)) < 0.1 * FORCE
    assert found.share > 0.95
