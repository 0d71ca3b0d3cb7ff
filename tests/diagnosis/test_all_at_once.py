"""All effects fitted together: which of them go is held to least squares, and a rig of several effects is found."""

from dataclasses import replace

import numpy as np
import pytest
from made import explanation, recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.criteria import NEAR_NOISE
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.all_at_once import all_at_once, found_by_a_fit, not_needed
from eha_core.diagnosis.search.candidates import Candidate, Search
from eha_core.diagnosis.search.initial_guesses import applicable_effects
from eha_core.effects import effects
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

LAWS = {effect.id: effect for effect in effects()}
NAMES = (
    "moving_mass",
    "constant_load.force",
    "pressure_sensor_bias.bias_a",
    "pressure_sensor_bias.bias_b",
    "hardening_spring.coefficient",
)
LINEAR = [LAWS[name] for name in ("constant_load", "pressure_sensor_bias", "hardening_spring")]


def regression(sizes: tuple[float, ...], alike: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Columns of a linear model and what it is fitted to; the load's and the spring's columns are so much alike."""
    generator = np.random.default_rng(5)
    columns = generator.standard_normal((400, len(sizes)))
    columns[:, 4] = alike * columns[:, 1] + (1.0 - alike) * columns[:, 4]
    return columns, columns @ np.array(sizes) + generator.standard_normal(400)


def fitted(columns: np.ndarray, measured: np.ndarray):
    """The least-squares fit of such a model, as a fit of the plant hands it over."""
    free = [FreeParameter(name, 0.0, False, 1.0, 30.0, -1e9, 1e9) for name in NAMES]
    q = np.linalg.lstsq(columns, measured, rcond=None)[0]
    return replace(explanation(dict(zip(NAMES, q, strict=True)), free), covariance=np.linalg.inv(columns.T @ columns))


def lost_without(columns: np.ndarray, measured: np.ndarray, places: tuple[int, ...]) -> float:
    """What the sum of squares rises by when these columns are left out and the others are fitted again."""
    rest = np.delete(columns, places, axis=1)
    squares = [np.sum((measured - x @ np.linalg.lstsq(x, measured, rcond=None)[0]) ** 2) for x in (columns, rest)]
    return float(squares[1] - squares[0])


def test_what_goes_costs_what_a_new_fit_without_it_loses():
    columns, measured = regression((1.0, 0.5, 0.02, -0.03, 0.3))
    loss = lost_without(columns, measured, (2, 3))
    model = fitted(columns, measured)
    assert not_needed(model, LINEAR, 1.001 * loss) == [LAWS["pressure_sensor_bias"]]
    assert not_needed(model, LINEAR, 0.999 * loss) == []


def test_of_two_that_stand_for_each_other_only_one_goes():
    """Either costs little while the other is there, both together cost much."""
    columns, measured = regression((1.0, 0.5, 1.0, 1.0, 0.0), alike=0.97)
    alone = [lost_without(columns, measured, (place,)) for place in (1, 4)]
    assert max(alone) < 30.0 < 0.5 * lost_without(columns, measured, (1, 4))
    gone = not_needed(fitted(columns, measured), LINEAR, 30.0)
    assert gone == [LAWS[("constant_load", "hardening_spring")[int(np.argmin(alone))]]]


def test_no_instant_is_fitted_from_afar_and_one_law_of_dry_friction_stands_for_all():
    chosen = {effect.id for effect in found_by_a_fit([effect for effect in effects() if effect.named])}
    assert not chosen & {"leakage_onset", "thermal_drift"}
    assert [effect for effect in chosen if LAWS[effect].kind == "dry friction"] == ["stribeck_friction"]
    assert {"bore_wear_leakage", "spool_hysteresis", "position_sensor_lag"} <= chosen


def test_five_effects_are_found_together():
    planted = {
        "constant_load.force": 300.0,
        "valve_deadband.half_width": 6e-5,
        "external_leakage.coefficient_a": 7e-13,
        "external_leakage.coefficient_b": 1e-12,
        "quadratic_damping.coefficient": 4e3,
        "pressure_sensor_lag.time_constant_a": 3e-3,
        "pressure_sensor_lag.time_constant_b": 3e-3,
    }
    given = {**nominal_values(), "moving_mass": 11.0, "bulk_modulus": 1.2e9, "valve_gain": 2.9e-5}
    observation = observe(recorded(planted, duration=8.0))
    calibration = calibrate([observation], NominalModel(given), 2e-4)
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    search = Search(calibration.problem, applicable_effects([observation]), scales, shorter=calibration.shorter)
    nominal = search.keep(NOTHING, calibration.fitted)
    assert nominal.times_noise > 100.0
    best = all_at_once(search, Candidate(NOTHING, nominal.fit))
    assert set(best.hypothesis.ids) == {name.split(".")[0] for name in planted}
    assert best.times_noise < NEAR_NOISE
    for name, value in planted.items():
        assert best.fit.values[name] == pytest.approx(value, rel=0.1), name
