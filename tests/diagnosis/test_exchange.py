"""What could stand in a member's place competes for it, with one effect more where it compensates for two."""

from dataclasses import replace

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search import exchange
from eha_core.diagnosis.search.candidates import Candidate, Proposal, Search
from eha_core.diagnosis.search.exchange import rivals_for, rivals_with_one_more
from eha_core.diagnosis.search.initial_guesses import applicable_effects
from eha_core.effects import effects
from eha_core.identification.fit import fit
from eha_core.identification.observation import observe
from eha_core.identification.parallel import side_by_side
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

LAWS = {effect.id: effect for effect in effects()}
SPRING = {"spring_stiffness": 2e4}
PLANTED = {
    "constant_load.force": 400.0,
    "turbulent_leakage.coefficient": 2e-8,
    "position_sensor_lag.time_constant": 0.003,
}


@pytest.fixture(scope="module")
def search():
    """Against a stiff spring a load is a position sensor that is off by 20 mm, as long as the stroke's ends are far."""
    observation = observe(recorded({**SPRING, **PLANTED}, duration=6.0))
    calibration = calibrate([observation], NominalModel({**nominal_values(), **SPRING}), 2e-4)
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    made = Search(calibration.problem, applicable_effects([observation]), scales, shorter=calibration.shorter)
    made.keep(NOTHING, calibration.fitted)
    return made


def fitted(search, values):
    chosen = [LAWS[name] for name in sorted({name.split(".")[0] for name in values})]
    begun = {**nominal_values(), **SPRING, **values}
    free = with_effects(search.found[NOTHING].free, chosen, begun)
    return search.try_proposal(Proposal(NOTHING.with_effects(chosen), begun, free, None), 30)


IMITATED = {"position_sensor_offset.offset": -0.02, "turbulent_leakage.coefficient": 2e-8}


def test_in_an_offsets_place_the_load_that_it_imitates_competes(search):
    best = fitted(search, IMITATED)
    offset = next(member for member in best.hypothesis.members if member.id == "position_sensor_offset")
    rivals = rivals_for(search, best, offset)
    load = next(one for one in rivals[:2] if one.hypothesis.ids == ("constant_load", "turbulent_leakage"))
    assert load.states is None, "the windows begin as measured"
    assert best.hypothesis not in [one.hypothesis for one in rivals]


def test_over_short_windows_those_ahead_after_one_iteration_compete_too(search, monkeypatch):
    best = fitted(search, IMITATED)
    leakage = next(member for member in best.hypothesis.members if member.id == "turbulent_leakage")
    few = rivals_for(search, best, leakage)
    more = rivals_for(replace(search, short=True, found=dict(search.found)), best, leakage)
    monkeypatch.setattr(exchange, "FOR_ONE_PLACE", 100)
    others = rivals_for(search, best, leakage)[len(few) :]
    assert [one.hypothesis for one in more[: len(few)]] == [one.hypothesis for one in few]
    reached = [fit(search.problem, one.values, one.free, None, iterations=1).objective for one in others]
    first, second = np.argsort(reached)[:2]
    assert [one.hypothesis for one in more[len(few) :]] == [others[first].hypothesis, others[second].hypothesis]
    assert (first, second) != (0, 1), "a linear prediction has them in another order"


def test_a_rival_that_leads_with_one_effect_more_is_taken_that_far(search):
    """The offset compensates for the load and the late sensor together, and is ahead of the load alone."""
    rival = fitted(search, {"constant_load.force": 400.0, "turbulent_leakage.coefficient": 2e-8})
    at = fitted(search, IMITATED)
    ahead = Candidate(at.hypothesis, replace(at.fit, objective=rival.fit.objective - 50.0))
    (found,) = rivals_with_one_more(search, ahead, 100.0)
    assert found.hypothesis.ids == ("constant_load", "position_sensor_lag", "turbulent_leakage")
    assert found.fit.objective < ahead.fit.objective - 100.0
    far_ahead = Candidate(at.hypothesis, replace(at.fit, objective=rival.fit.objective - 190.0))
    assert rivals_with_one_more(search, far_ahead, 100.0) == [], "the lag is predicted to gain 240, and 290 are needed"


def test_side_by_side_proposals_are_fitted_to_the_same_digits(search):
    best = fitted(search, IMITATED)
    offset = next(member for member in best.hypothesis.members if member.id == "position_sensor_offset")
    proposals = rivals_for(search, best, offset)
    said: list[str] = []
    alone, together = replace(search, found={}), replace(search, found={}, progress=said.append)
    one_by_one = [alone.try_proposal(proposal, 2).fit for proposal in proposals]
    with side_by_side(2):
        at_once = [candidate.fit for candidate in together.try_proposals(proposals, 2)]
    assert [one.values for one in at_once] == [one.values for one in one_by_one]
    assert all(np.array_equal(one.states, other.states) for one, other in zip(at_once, one_by_one, strict=True))
    assert said == [f"trying {' + '.join(proposal.hypothesis.ids)}" for proposal in proposals]
