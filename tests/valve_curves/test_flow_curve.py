"""Flow curves in closed form, and one of the exam's truth: each figure within its interval, and nothing invented."""

from __future__ import annotations

import numpy as np
import pytest
from bench import FULL, noisy, sweep, table, valve_flow
from scipy.signal import lfilter

import eha_core as eha
from eha_core.errors import EhaError
from eha_core.valve_curves import Value
from eha_exam.truth import simulate_truth

RIG = {"ratio": 0.1, "offset": 3e-4, "overlap": 5e-4, "half_width": 2e-4}
TRUE = {"null_shift": -3e-4, "flow_gain_positive": 2e-2, "flow_gain_negative": 1.8e-2, "asymmetry": 0.1,
        "overlap": 5e-4, "hysteresis": 4e-4}  # fmt: skip


def values_of(current: np.ndarray, flow: np.ndarray) -> dict[str, Value]:
    (fit,) = eha.curves([table(current, Q=flow)]).fits
    return fit.values


def test_every_figure_is_within_its_interval_as_often_as_it_says() -> None:
    inside, trials = dict.fromkeys(TRUE, 0), 25
    for seed in range(trials):
        values = values_of(sweep(), noisy(valve_flow(sweep(), **RIG), 0.005, seed))
        assert all(values[name].is_sure for name in TRUE)
        for name, true in TRUE.items():
            reach = values[name].reach
            assert reach is not None and reach < 0.2 * abs(true)
            inside[name] += abs(values[name].value - true) <= reach
    # of 25 trials at 95 %, fewer than 20 have a probability of 0.0002 for each of the six figures
    assert min(inside.values()) >= 20, inside


def test_a_sound_valve_has_none_of_it() -> None:
    found = dict.fromkeys(("null_shift", "asymmetry", "overlap", "hysteresis"), 0)
    for seed in range(25):
        values = values_of(sweep(), noisy(valve_flow(sweep()), 0.005, seed))
        assert not values.keys() & {"edge_rounding", "curvature", "saturation_positive", "saturation_negative"}
        for name in found:
            found[name] += values[name].is_sure
    assert max(found.values()) <= 5, found


def test_underlap_is_a_negative_overlap_and_no_dead_zone_of_the_plant() -> None:
    made = eha.curves([table(sweep(), Q=noisy(valve_flow(sweep(), overlap=-6e-4), 0.005, 3))])
    overlap = made.fits[0].values["overlap"]
    assert overlap.is_sure and abs(overlap.value + 6e-4) < overlap.reach
    assert "underlap" in made.left_out["valve_deadband.half_width"]


@pytest.mark.parametrize("share", [0.0, 0.002])
def test_saturation_is_found_and_moves_no_other_figure(share: float) -> None:
    values = values_of(sweep(), noisy(valve_flow(sweep(), **RIG, limit=3e-4), share, 1))
    for name, true in {**TRUE, "saturation_positive": 3e-4, "saturation_negative": 3e-4}.items():
        reach = values[name].reach
        assert reach is not None and abs(values[name].value - true) <= 1.5 * reach, name
    assert values["linearity_error"].value < 0.01


def test_a_bend_is_no_saturation() -> None:
    opened = valve_flow(sweep(), gain=1.0, overlap=4e-4)
    values = values_of(sweep(), noisy(2e-2 * opened / (1.0 + 20.0 * np.abs(opened)), 0.002, 2))
    assert not values.keys() & {"saturation_positive", "saturation_negative"}
    assert abs(values["curvature"].value - 20.0) < values["curvature"].reach
    assert values["linearity_error"].value > 0.01


def test_a_noisy_ammeter_makes_no_saturation() -> None:
    for seed in range(8):
        current = noisy(sweep(301), 0.002, 100 + seed)
        values = values_of(current, noisy(valve_flow(sweep(301), **RIG), 0.005, seed))
        assert not values.keys() & {"saturation_positive", "saturation_negative"}


def test_a_drifting_flow_meter_widens_the_intervals() -> None:
    """Noise that neighbouring points share: 2,000 of them are worth no more than some dozen."""
    inside = 0
    for seed in range(10):
        drift = lfilter([1.0], [1.0, -0.98], np.random.default_rng(seed).normal(0.0, 4e-7, sweep(301).size))
        values = values_of(sweep(301), valve_flow(sweep(301), **RIG) + drift)
        inside += sum(abs(values[name].value - true) <= (values[name].reach or 0.0) for name, true in TRUE.items())
    assert inside >= 50  # of 60; on average 57


def test_a_slow_triangle_of_the_truth_gives_its_valve_back() -> None:
    """The exam's truth shares no code with plant or curves; its flow is that of a piston without load."""
    true = {"valve_null_offset.offset": 6e-5, "valve_deadband.half_width": 2e-4, "flow_gain_asymmetry.ratio": 0.12,
            "spool_hysteresis.half_width": 1e-4}  # fmt: skip
    effects = [("valve_null_offset", {"offset": 6e-5}), ("valve_deadband", {"half_width": 2e-4, "rounding": 0.0}),
               ("flow_gain_asymmetry", {"ratio": 0.12}), ("spool_hysteresis", {"half_width": 1e-4})]  # fmt: skip
    rig = {"spring_stiffness": 0.0, "damping_coefficient": 50.0, "actuator_displacement": 5.0, "internal_leakage": 0.0}
    seconds = np.arange(0.0, 40.0, 0.01)
    voltage = 0.3 * (2.0 / np.pi) * np.arcsin(np.sin(2.0 * np.pi * seconds / 20.0))
    made = simulate_truth(rig, effects, voltage, 39.99, 100.0)
    rows = slice(50, None, 20)
    found = eha.curves(
        [table(made["current"][rows], Q=noisy(made["flow_a"][rows], 0.003, 5))], pressure_drop=2.1e7
    ).parameters
    by_name = {row.name: row for row in found}
    for name, value in true.items():
        assert by_name[name].is_sure and abs(by_name[name].value - value) < 1.5 * by_name[name].reach + 0.02 * value, (
            name
        )
    assert by_name["valve_gain"].value == pytest.approx(2.38e-5, rel=0.01)


def test_one_direction_of_travel_shows_no_hysteresis_and_says_so() -> None:
    current = np.linspace(-FULL, FULL, 41)
    made = eha.curves([table(current, Q=noisy(valve_flow(current, **RIG), 0.002, 1))])
    assert "hysteresis" not in made.fits[0].values
    assert "sweep up and down" in made.left_out["spool_hysteresis.half_width"]
    assert "--pressure-drop" in made.left_out["valve_gain"]


def test_a_turned_flow_meter_is_reported() -> None:
    made = eha.curves([table(sweep(), Q=-noisy(valve_flow(sweep(), **RIG), 0.002, 1))])
    assert any("sign was turned" in remark for remark in made.fits[0].remarks)
    assert made.fits[0].values["flow_gain_positive"].value == pytest.approx(2e-2, rel=0.01)


@pytest.mark.parametrize(
    "current, flow, said",
    [
        (sweep(2), valve_flow(sweep(2)), "points of a flow curve; measure 8 at least"),
        (sweep(), 0.0 * sweep(), "zero at every point"),
        (0.0 * sweep() + 0.01, valve_flow(sweep()), "the command is the same at every point"),
        (np.abs(sweep()), np.abs(valve_flow(sweep())), "a negative flow; measure both directions"),
        (sweep(), np.abs(valve_flow(sweep())), "a negative flow; measure both directions"),
        (sweep(), valve_flow(sweep()) * np.where(sweep() > 0.7 * FULL, 0.2, 1.0), "the flow falls by"),
        (sweep(), np.random.default_rng(1).normal(size=161), "the flow"),
    ],
)
def test_what_is_no_flow_curve_is_refused_in_a_line(current: np.ndarray, flow: np.ndarray, said: str) -> None:
    with pytest.raises(EhaError, match=said) as caught:
        eha.curves([table(current, Q=flow)])
    assert str(caught.value).startswith("columns: ")
