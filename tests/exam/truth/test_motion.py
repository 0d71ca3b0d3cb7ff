"""The hybrid automaton: the piston sticks, breaks away, meets stops and ends, exactly as a force balance says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lsim

from eha_exam.errors import ExamError
from eha_exam.truth import PositionController, resume_truth, simulate_truth

AREA = 645e-6
SINE = 0.05 * np.sin(2.0 * np.pi * 1.0 * np.arange(2001) / 1000.0)


def hydraulic_force(truth: dict[str, np.ndarray]) -> np.ndarray:
    return AREA * (truth["pressure_a"] - truth["pressure_b"]) - 10.0 * truth["position"]


@pytest.mark.parametrize("static", [300.0, 420.0])
def test_the_piston_rests_exactly_while_the_force_is_below_break_away(static: float) -> None:
    friction = {"force": 300.0, "static_force": static, "stribeck_velocity": 0.01}
    command = 0.05 * np.sin(2.0 * np.pi * np.arange(14001) / 20000.0)
    truth = simulate_truth({}, [("stribeck_friction", friction)], command, 0.7, 20000.0)
    force, resting = np.abs(hydraulic_force(truth)), truth["velocity"] == 0.0
    assert 200 < np.count_nonzero(resting) < 10000
    assert np.all(force[resting] <= static * (1.0 + 1e-6))
    broke_away = np.flatnonzero(resting[:-1] & ~resting[1:])
    assert np.all(force[broke_away] > 0.95 * static)
    still = np.flatnonzero(resting[1:] & resting[:-1])
    moved = np.abs(np.diff(truth["position"])[still])
    assert np.median(moved) == 0.0


def test_steady_slip_balances_friction_damping_and_pressure() -> None:
    effects = [("coulomb_friction", {"force": 300.0}), ("quadratic_damping", {"coefficient": 5000.0})]
    truth = simulate_truth({"spring_stiffness": 0.0}, effects, np.full(401, 0.05), 0.4)
    speed = truth["velocity"][-1]
    expected = 300.0 + 2000.0 * speed + 5000.0 * speed**2
    assert AREA * (truth["pressure_a"] - truth["pressure_b"])[-1] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("law", ["lugre", "lugre_tustin", "maxwell_slip", "bouc_wen"])
def test_bristles_are_a_spring_at_rest_and_coulomb_friction_in_steady_slip(law: str) -> None:
    bristles = {"force": 300.0, "static_force": 300.0, "stribeck_velocity": 0.01, "stiffness": 5e6, "damping": 800.0}
    effect = [("presliding_friction", bristles | {"law": law})]
    slip = simulate_truth({"spring_stiffness": 0.0}, effect, np.full(401, 0.05), 0.4)
    friction = AREA * (slip["pressure_a"] - slip["pressure_b"])[-1] - 2000.0 * slip["velocity"][-1]
    expected = 300.0 + (800.0 * slip["velocity"][-1] if law in ("maxwell_slip", "bouc_wen") else 0.0)
    assert friction == pytest.approx(expected, rel=5e-3)
    load = [("constant_load", {"force": 20.0}), *effect]
    held = simulate_truth({"internal_leakage": 1e-9, "spring_stiffness": 0.0}, load, np.zeros(1001), 1.0)
    creep = 20.0 / 5e6 if law in ("maxwell_slip", "bouc_wen") else held["position"][-1] / -1.0
    assert -held["position"][-1] == pytest.approx(creep, rel=0.02)


@pytest.mark.parametrize("law", ["kelvin_voigt", "hunt_crossley"])
def test_a_soft_stop_is_compressed_until_it_bears_the_full_pressure(law: str) -> None:
    stop = {"lower": -1.0, "upper": 0.01, "stiffness": 1e7, "damping": 1.0, "law": law}
    truth = simulate_truth({"internal_leakage": 0.0}, [("end_stop", stop)], np.full(1501, 0.1), 1.5)
    force = AREA * 2.1e7
    depth = force / 1e7 if law == "kelvin_voigt" else (force / 1e7) ** (2.0 / 3.0)
    assert truth["position"][-1] - 0.01 == pytest.approx(depth, rel=1e-3)


def test_the_cylinder_ends_hold_the_piston_and_let_it_go() -> None:
    command = np.concatenate([np.full(500, 1.0), np.full(501, -0.2)])
    truth = simulate_truth({}, [], command, 1.0)
    assert np.max(truth["position"]) <= 0.1 + 1e-11
    assert truth["position"][499] == pytest.approx(0.1, abs=1e-11)
    assert truth["velocity"][499] == 0.0
    assert truth["pressure_a"][499] == pytest.approx(2.1e7, rel=1e-3)
    assert truth["velocity"][-1] < -0.1


def test_an_effect_with_a_window_acts_only_there() -> None:
    load = [("constant_load", {"force": 500.0})]
    always, never = simulate_truth({}, load, SINE, 2.0), simulate_truth({}, [], SINE, 2.0)
    between = simulate_truth({}, load, SINE, 2.0, windows={"constant_load": (0.5005, 1.2)})
    np.testing.assert_array_equal(between["position"][:501], never["position"][:501])
    pressed = between["pressure_a"] - between["pressure_b"] - (never["pressure_a"] - never["pressure_b"])
    assert np.mean(AREA * pressed[800:1200]) == pytest.approx(500.0, rel=0.02)
    assert abs(np.mean(AREA * pressed[1400:])) < 5.0
    assert not np.allclose(always["position"], never["position"], atol=1e-5)


@pytest.mark.parametrize("begins", [0.2505, 0.7505, 1.2505, 1.7505])
def test_friction_opposes_the_motion_in_which_it_begins_to_act(begins: float) -> None:
    """Whichever way the piston has turned before: it was free to do so without an event."""
    friction = [("coulomb_friction", {"force": 300.0})]
    truth = simulate_truth({}, friction, SINE, 2.0, windows={"coulomb_friction": (begins, 10.0)})
    free = simulate_truth({}, [], SINE, 2.0)
    at = slice(round(1000.0 * begins) + 20, round(1000.0 * begins) + 80)
    pressed = truth["pressure_a"] - truth["pressure_b"] - (free["pressure_a"] - free["pressure_b"])
    assert np.min(np.abs(truth["velocity"][at])) > 0.01
    assert AREA * np.mean(pressed[at]) == pytest.approx(300.0 * np.sign(truth["velocity"][at][0]), rel=0.1)


def test_leakage_sets_in_at_its_time() -> None:
    onset = [("leakage_onset", {"time": 1.0, "internal_leakage": 2e-10})]
    truth, tight = simulate_truth({}, onset, SINE, 2.0), simulate_truth({}, [], SINE, 2.0)
    np.testing.assert_allclose(truth["position"][:1001], tight["position"][:1001], atol=1e-10)
    swing = np.ptp(truth["position"][1001:]) / np.ptp(tight["position"][1001:])
    assert swing == pytest.approx(1.0 / (1.0 + 2e-10 * 2000.0 / AREA**2), rel=0.02)


def test_sensors_report_what_their_laws_say() -> None:
    effects = [
        ("position_sensor_scale", {"ratio": 0.05}),
        ("pressure_sensor_bias", {"bias_a": 2e5, "bias_b": -1e5}),
        ("position_sensor_backlash", {"half_width": 1e-4}),
    ]
    truth = simulate_truth({}, effects, SINE, 2.0)
    np.testing.assert_allclose(truth["measured_pressure_a"] - truth["pressure_a"], 2e5)
    np.testing.assert_allclose(truth["measured_pressure_b"] - truth["pressure_b"], -1e5)
    gap = truth["measured_position"] / 1.05 - truth["position"]
    assert np.max(np.abs(gap)) <= 1e-4 + 1e-12
    assert np.max(gap) == pytest.approx(1e-4)
    assert np.min(gap) == pytest.approx(-1e-4)


def test_a_lagging_sensor_trails_a_ramp_by_its_time_constant() -> None:
    truth = simulate_truth({}, [("position_sensor_lag", {"time_constant": 0.01})], np.full(401, 0.05), 0.4)
    behind = truth["position"][-1] - truth["measured_position"][-1]
    assert behind == pytest.approx(0.01 * truth["velocity"][-1], rel=5e-3)


@pytest.mark.parametrize(
    ("law", "numerator", "denominator"),
    [("first_order", [1.0], [0.02, 1.0]), ("critically_damped", [1.0], [1e-4, 0.02, 1.0])],
)
def test_a_late_pressure_is_what_its_filter_makes_of_the_pressure(
    law: str, numerator: list[float], denominator: list[float]
) -> None:
    late = ("pressure_sensor_lag", {"time_constant_a": 0.02, "time_constant_b": 0.0, "law": law})
    command = 0.1 * np.sin(2.0 * np.pi * 8.0 * np.arange(1001) / 1000.0)
    truth = simulate_truth({}, [late, ("pressure_sensor_bias", {"bias_a": 3e5, "bias_b": 0.0})], command, 1.0)
    swing = truth["pressure_a"] - truth["pressure_a"][0]
    _, expected, _ = lsim((numerator, denominator), swing, truth["time"])
    np.testing.assert_allclose(truth["measured_pressure_a"] - 3e5 - truth["pressure_a"][0], expected, atol=300.0)
    np.testing.assert_array_equal(truth["measured_pressure_b"], truth["pressure_b"])
    assert np.max(np.abs(expected - swing)) > 1e5


@pytest.mark.parametrize("law", ["first_order", "critically_damped"])
def test_late_pressures_go_on_where_the_truth_is_resumed(law: str) -> None:
    late = [("pressure_sensor_lag", {"time_constant_a": 0.01, "time_constant_b": 0.02, "law": law})]
    truth = simulate_truth({}, late, SINE, 0.5)
    again, without = resume_truth({}, late, truth, 200, 500), resume_truth({}, [], truth, 200, 500)
    for name in ("measured_pressure_a", "measured_pressure_b"):
        np.testing.assert_allclose(again[name], truth[name][200:501], atol=50.0)
        np.testing.assert_array_equal(without[name], without[name.removeprefix("measured_")])


def test_a_controller_closes_the_loop_on_the_measured_position() -> None:
    reference = np.full(3001, 0.02)
    controller = PositionController(reference, gain=8.0)
    truth = simulate_truth({}, [("position_sensor_scale", {"ratio": 0.1})], controller, 3.0)
    assert truth["measured_position"][-1] == pytest.approx(0.02, rel=1e-3)
    assert truth["position"][-1] == pytest.approx(0.02 / 1.1, rel=1e-3)


@pytest.mark.parametrize(
    ("plant", "effects", "message"),
    [
        ({"mass": 3.0}, [], "mass"),
        ({}, [("rust", {})], "rust"),
        ({}, [("coulomb_friction", {"height": 3.0})], "height"),
    ],
)
def test_what_the_truth_does_not_know_is_said(
    plant: dict[str, float], effects: list[tuple[str, dict[str, float]]], message: str
) -> None:
    with pytest.raises(ExamError, match=message):
        simulate_truth(plant, effects, np.zeros(11), 0.01)


def test_a_truth_that_cannot_be_integrated_says_so_once(capfd: pytest.CaptureFixture[str]) -> None:
    """A piston a metre beyond the end of its stroke; the solver's own messages would come between what is printed."""
    truth = simulate_truth({}, [], SINE, 1.0)
    with pytest.raises(ExamError, match="cannot be integrated past 0"):
        resume_truth({}, [], truth, 500, 700, shift={"position": 1.0})
    assert capfd.readouterr() == ("", "")


def test_a_truth_that_runs_away_cannot_be_integrated() -> None:
    """At a pressure without bounds the volume of oil with air in it is nothing, and is divided by."""
    air = [("entrained_air", {"air_fraction": 0.02})]
    truth = simulate_truth({}, air, SINE, 1.0)
    with pytest.raises(ExamError, match="cannot be integrated past 0.5"):
        resume_truth({}, air, truth, 500, 700, shift={"pressure_a": 1e148})
