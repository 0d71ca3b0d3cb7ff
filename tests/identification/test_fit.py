"""The fit finds what a recording was made with, and says honestly how well."""

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.effects import effect
from eha_core.identification.fit import TRIALS, fit
from eha_core.identification.observation import observe
from eha_core.identification.problem import whole
from eha_core.identification.segments import coarser, cut
from eha_core.identification.shooting import SLOPE_STEP, Shooting
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

OTHER = {"moving_mass": 11.5, "damping_coefficient": 1600.0, "bulk_modulus": 1.1e9, "valve_gain": 2.0e-5}


def test_parameters_off_by_a_fifth_are_found_within_their_deviations():
    calibration = calibrate([observe(recorded(OTHER))], NominalModel(nominal_values()), 2e-4)
    fitted = calibration.fitted
    assert fitted.data / fitted.count == pytest.approx(1.0, abs=0.03)
    for name, value in OTHER.items():
        assert abs(fitted.values[name] - value) < 4.0 * fitted.deviation(name)
    assert calibration.nominal.data > 5.0 * fitted.data


def test_the_nominal_model_as_given_explains_its_own_recording():
    calibration = calibrate([observe(recorded({}))], NominalModel(nominal_values()), 2e-4)
    assert calibration.nominal.data / calibration.nominal.count == pytest.approx(1.0, abs=0.04)


def test_windows_from_the_true_states_meet_without_a_gap():
    observation = observe(recorded({}, noise=1e-3))
    shooting = cut(observation, nominal_values())
    _, ends = shooting.simulate(nominal_values(), shooting.initial_states)
    gaps = np.abs(ends[:-1] - shooting.initial_states[1:])
    assert np.all(np.median(gaps, axis=0) < [2e-6, 2e-3, 500.0, 500.0])


def test_the_coarser_problem_samples_the_same_instants():
    observation = observe(recorded({"coulomb_friction.force": 150.0}))
    fine = cut(observation, nominal_values())
    coarse = coarser(fine, 5e-4)
    states, values = fine.initial_states, nominal_values()
    for one, other in zip(
        fine.sample(fine.simulate(values, states)[0]), coarse.sample(coarse.simulate(values, states)[0]), strict=True
    ):
        assert len(one) == len(other)
        assert np.max(np.abs(one - other)) < 0.02 * np.ptp(one)


def test_a_fit_goes_on_where_bounds_cut_its_moves_short():
    planted = {"constant_load.force": 60.0, "valve_deadband.half_width": 2e-4}
    calibration = calibrate([observe(recorded(planted, duration=4.0))], NominalModel(nominal_values()), 2e-4)
    assert calibration.fitted.objective < 0.1 * calibration.nominal.objective


def test_a_fit_does_not_end_where_only_its_derivatives_are_wrong():
    """Coil, spool and oil move a little there: with coarse derivatives no step led lower, at twice the bulk modulus."""
    calibration = calibrate([observe(recorded({}, duration=4.0))], NominalModel(nominal_values()), 2e-4)
    assert calibration.fitted.values["bulk_modulus"] < 1.5 * nominal_values()["bulk_modulus"]


def test_dampings_in_lock_step_lead_where_one_after_the_other_does(monkeypatch):
    """Of those that lead lower the least is taken; some iterations of this fit need more than one."""
    shooting = cut(observe(recorded({"valve_deadband.half_width": 3e-4}, duration=4.0)), nominal_values())
    begun = nominal_values() | {"valve_deadband.half_width": 1e-4, "valve_deadband.rounding": 5e-5}
    free = with_effects((), [effect("valve_deadband")], begun)
    together, one_by_one = Shooting.simulate_many, []

    def in_turn(shooting, sets):
        if shooting.step_size == SLOPE_STEP:  # derivatives
            return together(shooting, sets)
        one_by_one.append(len(sets))
        results = [shooting.simulate(*one) for one in sets]
        return tuple(np.stack(arrays, axis=-1) for arrays in zip(*results, strict=True))

    at_once = fit(whole(shooting), begun, free)
    monkeypatch.setattr(Shooting, "simulate_many", in_turn)
    after_the_other = fit(whole(shooting), begun, free)
    assert one_by_one and set(one_by_one) == {TRIALS}
    assert (at_once.ending, at_once.iterations) == (after_the_other.ending, after_the_other.iterations)
    assert at_once.q.tobytes() == after_the_other.q.tobytes()
    assert at_once.states.tobytes() == after_the_other.states.tobytes()
