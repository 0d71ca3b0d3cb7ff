"""Pressure gain and leakage curves of blocked ports whose balance of flows is solved by bisection."""

from __future__ import annotations

import numpy as np
import pytest
from bench import FULL, blocked_ports, noisy, played, sweep, table, valve_flow

import eha_core as eha
from eha_core.errors import EhaError

SUPPLY, GAIN, CONDUCTANCE, WIDTH = 2.1e7, 2.38e-5, 5e-12, 2e-3
FLOW = noisy(valve_flow(sweep(), gain=GAIN * np.sqrt(SUPPLY / 2.0)), 0.003, 1)


def test_the_pressure_gain_is_the_slope_at_null() -> None:
    current = 0.1 * sweep()
    spool = played(current, 5e-5) + 2e-4
    load = np.array([blocked_ports(at, GAIN, CONDUCTANCE, 1.0, SUPPLY)[0] for at in spool])
    made = eha.curves([table(current, pL=noisy(load, 0.003, 2))])
    values = made.fits[0].values
    # K o sqrt(P_s (1 - q) / 2) = G P_s q for a load pressure q P_s: the slope at null, and the chord to 40 %
    slope = GAIN * np.sqrt(SUPPLY / 2.0) / CONDUCTANCE
    assert slope * np.sqrt(0.6) < values["pressure_gain"].value < slope
    assert abs(values["null_shift"].value + 2e-4) < values["null_shift"].reach
    assert abs(values["hysteresis"].value - 1e-4) < values["hysteresis"].reach
    by_name = {row.name: row.value for row in made.parameters}
    assert by_name["valve_null_offset.offset"] == pytest.approx(2e-4, rel=0.05)


def test_two_pressures_are_their_difference() -> None:
    load = 2e7 * np.tanh((sweep() - 1e-3) / 3e-3)
    one = eha.curves([table(sweep(), pL=load)]).fits[0].values
    two = eha.curves([table(sweep(), pB=1e7 - 0.5 * load, pA=1e7 + 0.5 * load)]).fits[0].values
    assert two["pressure_gain"].value == pytest.approx(one["pressure_gain"].value, rel=1e-9)


def leakage(spool: np.ndarray) -> np.ndarray:
    return np.array([blocked_ports(at, GAIN, CONDUCTANCE, WIDTH, SUPPLY)[1] for at in spool])


def test_the_lands_conductance_follows_from_leakage_and_flow_curve() -> None:
    inside = []
    for seed in range(10):
        curve = table(sweep(), leakage=noisy(leakage(sweep()) + 4e-6, 0.004, seed))
        made = eha.curves([table(sweep(), Q=FLOW), curve], pressure_drop=SUPPLY, supply_pressure=SUPPLY)
        by_name = {row.name: row for row in made.parameters}
        for name, true in (("conductance", CONDUCTANCE), ("width", WIDTH)):
            found = by_name[f"valve_null_leakage.{name}"]
            assert found.value == pytest.approx(true, rel=0.1)
            inside.append(abs(found.value - true) < found.reach)
    assert np.mean(inside) >= 0.8


def test_without_the_flow_curve_the_leakage_alone_is_given() -> None:
    peak = 2e-5 / (1.0 + ((sweep() + 3e-4) / 1e-3) ** 2) + 5e-6
    made = eha.curves([table(sweep(), leakage=noisy(peak, 0.005, 4))], supply_pressure=SUPPLY)
    values = made.fits[0].values
    for name, true in (("null_leakage", 2.5e-5), ("null_shift", -3e-4), ("leakage_far_from_null", 5e-6)):
        assert abs(values[name].value - true) < 1.5 * values[name].reach, name
    assert not made.parameters
    assert "the flow curve" in made.left_out["valve_null_leakage.conductance"]


def test_a_peak_of_another_shape_gives_no_conductance() -> None:
    peak = 2e-5 / (1.0 + ((sweep() + 3e-4) / 1e-3) ** 2) + 5e-6
    curves = [table(sweep(), Q=FLOW), table(sweep(), leakage=noisy(peak, 0.002, 4))]
    made = eha.curves(curves, pressure_drop=SUPPLY, supply_pressure=SUPPLY)
    assert "another shape" in made.left_out["valve_null_leakage.conductance"]


@pytest.mark.parametrize(
    "columns, said",
    [
        ({"pL": 0.0 * sweep()}, "zero at every point"),
        ({"pL": 1e7 + 0.0 * sweep()}, "measure both signs"),
        ({"pL": 2e7 * np.sign(sweep() + 1e-6)}, "measure about null in smaller steps"),
        ({"leakage": 0.0 * sweep()}, "nowhere positive"),
        ({"leakage": 1e-5 + 1e-3 * np.abs(sweep())}, "no peak"),
        ({"leakage": noisy(1e-5 + 0.0 * sweep(), 0.01, 1)}, "no peak"),
    ],
)
def test_what_is_no_curve_of_blocked_ports_is_refused_in_a_line(columns: dict[str, np.ndarray], said: str) -> None:
    with pytest.raises(EhaError, match=said):
        eha.curves([table(sweep(), **columns)])


def test_two_curves_of_one_kind_are_refused() -> None:
    with pytest.raises(EhaError, match="second flow curve"):
        eha.curves([table(sweep(), Q=FLOW), table(np.clip(sweep(), -FULL, FULL), Q=FLOW)])
