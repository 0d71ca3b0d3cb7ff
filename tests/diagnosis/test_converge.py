"""A fit that stopped short of its optimum is led there."""

from dataclasses import replace

import pytest
from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.effect_parameters import free_effect_parameters, free_instants
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.converge import comes_near, converge
from eha_core.diagnosis.search.warm_start import warm_start
from eha_core.effects import effect, effects
from eha_core.identification.fit import fit
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

ONSET = next(effect for effect in effects() if effect.id == "leakage_onset")
PLANTED = {"leakage_onset.time": 4.87, "leakage_onset.internal_leakage": 1e-10}


@pytest.fixture(scope="module")
def calibration():
    return calibrate([observe(recorded(PLANTED, duration=8.0))], NominalModel(nominal_values()), 2e-4)


def test_an_instant_a_second_off_is_found(calibration):
    values = {**calibration.fitted.values, **PLANTED, "leakage_onset.time": 3.6}
    free = (*calibration.fitted.free, *free_effect_parameters(ONSET, values))
    stuck = fit(calibration.problem, values, free, calibration.fitted.states)
    assert abs(stuck.values["leakage_onset.time"] - 4.87) > 0.3
    (found,) = converge(calibration.problem, {NOTHING.with_effects([ONSET]): stuck}).values()
    assert found.values["leakage_onset.time"] == pytest.approx(4.87, abs=0.01)
    assert found.data < 1.05 * found.count


def test_when_friction_acts_is_looked_for_once_and_told_to_its_other_laws(monkeypatch):
    recording = recorded({"coulomb_friction.force": 200.0, "effects_from": 2.37, "effects_until": 5.71}, duration=8.0)
    calibration = calibrate([observe(recording)], NominalModel(nominal_values()), 2e-4)
    found = {}
    laws = {
        "coulomb_friction": {"force": 200.0},
        "stribeck_friction": {"force": 199.0, "static_force": 201.0, "stribeck_velocity": 0.01},
    }
    for law, sizes in laws.items():
        span = {f"{law}.acts_from": 2.37, f"{law}.acts_until": 5.69}
        values = {**nominal_values(), **{f"{law}.{name}": value for name, value in sizes.items()}, **span}
        own = (*free_effect_parameters(effect(law), values), *free_instants(span, ((1.4, 3.4), (4.6, 6.6))))
        free = (*calibration.fitted.free, *own)
        fitted = fit(calibration.problem, values, free, calibration.fitted.states)
        found[NOTHING.with_effects([effect(law)], limited=True)] = fitted
    fits = []

    def counted(*given, **how):
        fits.append(given[2])
        return fit(*given, **how)

    monkeypatch.setattr("eha_core.diagnosis.search.converge.fit", counted)
    converged = converge(calibration.problem, found)
    fewer, more = sorted(sum(f"{law}.acts_until" in {one.name for one in free} for free in fits) for law in laws)
    assert 0 < fewer < 5 and more > 20
    both = warm_start(calibration.problem, converged)
    for result, law in zip(both.values(), laws, strict=True):
        assert result.values[f"{law}.acts_until"] == pytest.approx(5.71, abs=0.002)
        assert result.data < calibration.problem.count()


def test_what_may_come_to_lead_lies_within_reach_of_the_best(calibration):
    count = calibration.problem.count()
    near, far = (replace(calibration.fitted, objective=count + behind) for behind in (299.0, 301.0))
    assert comes_near(calibration.problem, near, count) and not comes_near(calibration.problem, far, count)
    # half of what the best leaves over may still be gained
    assert comes_near(calibration.problem, far, 1.1 * count)
    assert not comes_near(calibration.problem, replace(far, objective=1.2 * count + 301.0), 1.1 * count)
