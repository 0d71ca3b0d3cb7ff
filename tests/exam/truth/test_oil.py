"""The truth's chambers against closed forms: trapped oil, leakage, conserved volume, air."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson

from eha_exam.truth import simulate_truth
from eha_exam.truth.laws import stiffness_of_oil, valve_flows
from eha_exam.truth.record import neutral_record, with_effect

AREA, BULK, LINE, STROKE = 645e-6, 1.4e9, 1e-5, 0.1
CLAMPED = ("coulomb_friction", {"force": 1e7})


def still(samples: int) -> np.ndarray:
    return np.zeros(samples)


def test_trapped_oil_is_a_spring_of_known_stiffness() -> None:
    load, mass = 100.0, 9.0
    plant = {"internal_leakage": 0.0, "damping_coefficient": 60.0}
    position = simulate_truth(plant, [("constant_load", {"force": load})], still(20001), 1.0, 20000.0)["position"]
    stiffness = 2.0 * BULK * AREA**2 / (LINE + AREA * STROKE) + 10.0
    assert np.mean(position[-2000:]) == pytest.approx(-load / stiffness, rel=2e-3)
    crossings = np.flatnonzero(np.diff(np.sign(position[:4000] + load / stiffness)))
    period = 2.0 * np.mean(np.diff(crossings)) / 20000.0
    assert period == pytest.approx(2.0 * np.pi * np.sqrt(mass / stiffness), rel=2e-3)


def test_external_leakage_empties_each_chamber_exponentially() -> None:
    leakage = ("external_leakage", {"coefficient_a": 2e-13, "coefficient_b": 5e-13})
    truth = simulate_truth({"internal_leakage": 0.0}, [CLAMPED, leakage], still(501), 0.5)
    volume = LINE + AREA * STROKE
    for pressure, coefficient in (("pressure_a", 2e-13), ("pressure_b", 5e-13)):
        expected = 1.05e7 * np.exp(-BULK * coefficient / volume * truth["time"])
        np.testing.assert_allclose(truth[pressure], expected, rtol=1e-6)


def test_internal_leakage_levels_the_chambers() -> None:
    plant = {"internal_leakage": 1e-12, "piston_area_b": 0.5 * AREA}
    truth = simulate_truth(plant, [CLAMPED], still(501), 0.5)
    volume_a, volume_b = LINE + AREA * STROKE, LINE + 0.5 * AREA * STROKE
    rate = BULK * 1e-12 * (1.0 / volume_a + 1.0 / volume_b)
    difference = truth["pressure_a"] - truth["pressure_b"]
    np.testing.assert_allclose(difference, difference[0] * np.exp(-rate * truth["time"]), rtol=1e-6, atol=5.0)


@pytest.mark.parametrize(
    ("law", "share"),
    [
        ({}, 1.0 / np.cosh(0.6) ** 2),
        ({"law": "gaussian"}, np.exp(-0.36)),
        ({"law": "clearance"}, ((1.0 + np.exp(-0.36)) ** 3 - 1.0) / 7.0),
    ],
    ids=["bell", "gaussian", "clearance"],
)
def test_a_worn_bore_levels_the_chambers_as_fast_as_it_is_worn_where_the_piston_stands(
    law: dict[str, str], share: float
) -> None:
    """Piston at 14 mm, 0.6 widths from the centre; the friction holds it there."""
    wear = ("bore_wear_leakage", {"coefficient": 1e-12, "centre": 0.02, "width": 0.01, **law})
    plant = {"internal_leakage": 2e-13, "piston_area_b": 0.5 * AREA}
    truth = simulate_truth(plant, [CLAMPED, wear], still(501), 0.5, initial_position=0.014)
    volume_a, volume_b = LINE + AREA * (STROKE + 0.014), LINE + 0.5 * AREA * (STROKE - 0.014)
    rate = BULK * (2e-13 + 1e-12 * share) * (1.0 / volume_a + 1.0 / volume_b)
    difference = truth["pressure_a"] - truth["pressure_b"]
    np.testing.assert_allclose(difference, difference[0] * np.exp(-rate * truth["time"]), rtol=1e-6, atol=5.0)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_relief_valve_across_the_piston_leaks_one_way_and_above_its_opening(direction: float) -> None:
    """The difference falls to the opening as the charge of a capacitor, or stays where it was."""
    relief = ("relief_leakage", {"coefficient": 1e-12, "opening": 1e6, "direction": direction})
    plant = {"internal_leakage": 0.0, "piston_area_b": 0.5 * AREA}
    truth = simulate_truth(plant, [CLAMPED, relief], still(501), 0.5)
    rate = BULK * 1e-12 * (1.0 / (LINE + AREA * STROKE) + 1.0 / (LINE + 0.5 * AREA * STROKE))
    difference = truth["pressure_a"] - truth["pressure_b"]
    assert difference[0] == pytest.approx(-7e6)
    fallen = -1e6 - 6e6 * np.exp(-rate * truth["time"])
    np.testing.assert_allclose(difference, fallen if direction < 0.0 else -7e6, rtol=1e-6)


def test_the_oil_that_flows_in_is_swept_or_compressed() -> None:
    rate = 10000.0
    command = 0.1 * np.sin(2.0 * np.pi * 2.0 * np.arange(5001) / rate)
    plant = {"internal_leakage": 0.0, "piston_area_b": 0.7 * AREA}
    truth = simulate_truth(plant, [], command, 0.5, rate)
    for sign, pressure, flow, area in ((1.0, "pressure_a", "flow_a", AREA), (-1.0, "pressure_b", "flow_b", 0.7 * AREA)):
        volume = LINE + area * (STROKE + sign * truth["position"])
        stored = np.log(volume / volume[0]) + (truth[pressure] - truth[pressure][0]) / BULK
        supplied = cumulative_simpson(sign * truth[flow] / volume, x=truth["time"], initial=0.0)
        np.testing.assert_allclose(stored, supplied, atol=2e-7 * np.max(np.abs(np.log(volume / volume[0]))) + 2e-8)


@pytest.mark.parametrize("law", ["cho", "nykanen"])
def test_air_softens_the_oil_at_low_pressure_and_not_at_high(law: str) -> None:
    record = with_effect(neutral_record({}), ("entrained_air", {"air_fraction": 0.02, "law": law}))[0]
    assert stiffness_of_oil(0.0, record) == pytest.approx(1.4 * 101325.0 / 0.02, rel=0.03)
    assert stiffness_of_oil(3e7, record) == pytest.approx(BULK, rel=0.04)
    assert np.all(np.diff([stiffness_of_oil(p, record) for p in np.linspace(0.0, 2e7, 50)]) > 0.0)


def test_the_air_law_is_the_derivative_of_the_mixture_volume() -> None:
    record = with_effect(neutral_record({}), ("entrained_air", {"air_fraction": 0.01}))[0]

    def volume(gauge: float) -> float:
        return 0.99 * np.exp(-gauge / BULK) + 0.01 * (101325.0 / (gauge + 101325.0)) ** (1.0 / 1.4)

    for gauge in (1e5, 1e6, 1e7):
        slope = (volume(gauge * 1.0001) - volume(gauge * 0.9999)) / (0.0002 * gauge)
        assert stiffness_of_oil(gauge, record) == pytest.approx(-volume(gauge) / slope, rel=1e-5)


def test_no_flow_is_lost_in_the_valve() -> None:
    effects = [
        ("valve_null_leakage", {"conductance": 1e-12, "width": 2e-4, "underlap": 1e-4}),
        ("valve_deadband", {"half_width": 1e-4, "rounding": 5e-5}),
        ("flow_gain_asymmetry", {"ratio": 0.2}),
    ]
    record = neutral_record({})
    for effect in effects:
        record = with_effect(record, effect)
    for spool in (-3e-3, -1e-4, 0.0, 2e-5, 4e-3):
        into_a, out_of_b, drawn, returned = valve_flows(spool, 1.2e7, 0.7e7, 2.1e7, 1e5, record[0])
        assert drawn - returned == pytest.approx(into_a - out_of_b, rel=1e-12)
        assert drawn > 0.0
        assert returned > 0.0


def test_the_rod_side_sets_the_ratio_of_speeds() -> None:
    ratio = 0.6
    plant = {"piston_area_b": ratio * AREA, "damping_coefficient": 200.0, "internal_leakage": 0.0}
    out = simulate_truth(plant, [], np.full(1001, 0.01), 1.0)["velocity"][-1]
    back = simulate_truth(plant, [], np.full(1001, -0.01), 1.0)["velocity"][-1]
    assert out == pytest.approx(2.38e-5 * 1e-4 * np.sqrt(2.1e7 / (1.0 + ratio**3)) / AREA, rel=2e-3)
    assert -back / out == pytest.approx(np.sqrt(ratio), rel=2e-3)


def test_supply_and_return_settle_where_the_flow_puts_them() -> None:
    effects = [
        ("supply_pressure_droop", {"resistance": 2e11, "time_constant": 0.02}),
        ("return_back_pressure", {"resistance": 1e11, "time_constant": 0.02}),
    ]
    truth = simulate_truth({"internal_leakage": 0.0}, effects, np.full(401, 0.01), 0.4)
    assert truth["supply_pressure"][-1] == pytest.approx(2.1e7 - 2e11 * truth["flow_a"][-1], rel=1e-4)
    assert truth["return_pressure"][-1] == pytest.approx(1e11 * truth["flow_b"][-1], rel=1e-3)
