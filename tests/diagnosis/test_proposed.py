"""Every effect of the catalogue, planted in the plant and proposed, fitted and measured behind wrong parameters."""

import pytest
from made import LAWS
from planted import NOT_IDENTIFIABLE, planted, require_measured

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.best_sets import best_sets
from eha_core.diagnosis.search.columns import applicable_effects, columns_of
from eha_core.diagnosis.search.course import states_over
from eha_core.diagnosis.search.pool import Pool, Trace
from eha_core.diagnosis.search.quadratic import quadratic_model
from eha_core.identification.fit import fit
from eha_core.identification.problem import whole
from eha_core.nominal import NominalModel

FOUND = [effect for effect in LAWS.values() if effect.named and effect.id not in NOT_IDENTIFIABLE]


@pytest.mark.parametrize("effect", FOUND, ids=lambda one: one.id)
def test_what_is_planted_is_proposed_and_measured(effect):
    values, nominal, observation = planted(effect)
    calibration = calibrate([observation], NominalModel(nominal), 2e-4)
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    columns = [column for one in applicable_effects([observation]) for column in columns_of(one, scales)]
    pool = Pool(whole(calibration.shorter[1]), calibration.fitted.free, Trace())
    begun = pool.try_set("nominal", NOTHING, nominal, None, 8)
    model = quadratic_model(pool.problem, begun, NOTHING, pool.plant, columns, in_time=True)
    proposed = [one for one in best_sets(model, 1)[1] if one.options[0].member.id == effect.id]
    assert proposed, [one.options[0].member.id for one in best_sets(model, 1)[1]]
    hypothesis = NOTHING.with_effects([effect])
    for one in proposed[:3]:
        pool.try_set("planted", hypothesis, *model.start(one.options), 12, in_a_row=2)
    at = pool.found[hypothesis]
    states = states_over(calibration.problem, pool.problem.shooting, at)
    result = fit(calibration.problem, at.values, at.free, states, iterations=25, in_a_row=2)
    assert result.data / result.count < 1.1
    assert calibration.fitted.objective - result.objective > 50.0
    require_measured(effect, values, result)
