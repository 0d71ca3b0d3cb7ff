"""A set grown over short windows is the rig's, where over long ones each break-away is a valley of its own."""

import pytest
from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search import over_short_windows
from eha_core.diagnosis.search.candidates import Candidate, Search
from eha_core.diagnosis.search.initial_guesses import applicable_effects
from eha_core.diagnosis.search.over_short_windows import grown_over_short_windows
from eha_core.identification.observation import observe
from eha_core.identification.short_windows import HELD, SHORT, VERY_SHORT
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

PLANTED = {
    "stribeck_friction.force": 400.0,
    "stribeck_friction.static_force": 580.0,
    "stribeck_friction.stribeck_velocity": 0.03,
    "valve_deadband.half_width": 1e-4,
    "external_leakage.coefficient_a": 4e-12,
    "external_leakage.coefficient_b": 6e-12,
}
SET = ("external_leakage", "stribeck_friction", "valve_deadband")


@pytest.fixture(scope="module")
def search():
    observation = observe(recorded(PLANTED, duration=6.0))
    given = {**nominal_values(), "bulk_modulus": 0.8 * nominal_values()["bulk_modulus"]}
    calibration = calibrate([observation], NominalModel(given), 2e-4)
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    short = {"shorter": calibration.shorter, "shortest": calibration.shortest}
    made = Search(calibration.problem, applicable_effects([observation]), scales, **short)
    made.keep(NOTHING, calibration.fitted)
    return made


def test_three_effects_at_once_are_found_from_the_nominal_values(search):
    found = grown_over_short_windows(search, Candidate(NOTHING, search.found[NOTHING]))
    assert found.hypothesis.ids == SET and found.times_noise < 1.05
    for name in ("valve_deadband.half_width", "external_leakage.coefficient_a", "external_leakage.coefficient_b"):
        assert found.fit.values[name] == pytest.approx(PLANTED[name], rel=0.1), name
    assert search.found.keys() == {NOTHING, found.hypothesis}, "of what was fitted over short windows only the best"


def test_where_more_than_noise_is_left_it_is_tried_over_shorter_windows_and_with_the_nominal_values_held(
    search, monkeypatch
):
    scouts = []

    def nothing_grows(scout, best):
        scouts.append((scout, best))
        return best

    monkeypatch.setattr(over_short_windows, "grow", nothing_grows)
    search.found = {NOTHING: search.found[NOTHING]}
    assert grown_over_short_windows(search, Candidate(NOTHING, search.found[NOTHING])).hypothesis == NOTHING
    (free, as_believed), (shortest, believed_again), (held, near_what_was_given) = scouts
    for scout, length in ((free, SHORT[0]), (shortest, VERY_SHORT[0]), (held, SHORT[0])):
        edges = scout.problem.shooting.edges * scout.problem.shooting.step_size
        assert scout.short and edges[1] - edges[0] == pytest.approx(length)
    assert believed_again.fit.free == as_believed.fit.free
    for one, other in zip(as_believed.fit.free, near_what_was_given.fit.free, strict=True):
        assert other.prior_deviation == pytest.approx(HELD * one.prior_deviation)
