"""Orifices, compressibility and leakage, equations (3) to (9), against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.parameters import changed, nominal_values
from eha_core.plant import Plant
from eha_core.plant.equations import TRANSITION_PRESSURE, orifice_root
from eha_core.plant.packing import pack
from eha_core.plant.step import oil_half_step
from eha_core.plant.vector import INTERNAL_LEAKAGE


def oil(
    parameters: dict[str, float],
    tau: float,
    steps: int,
    start: tuple[float, float],
    velocity: float = 0.0,
    leakage_ratio: float = 1.0,
) -> np.ndarray:
    """Pressures after each of the steps of a shut valve's chambers, the piston moving steadily from the middle."""
    vector, active, _ = pack(changed(nominal_values(), parameters), 1e-4)
    pressure_a, pressure_b = start
    leakage = leakage_ratio * vector[INTERNAL_LEAKAGE]
    rows = []
    for k in range(steps):
        middle = (k + 0.5) * tau * velocity
        pressure_a, pressure_b, *_ = oil_half_step(
            tau, 0.0, 0.0, middle, velocity, pressure_a, pressure_b, 2.1e7, 0.0, leakage, vector, active
        )
        rows.append((pressure_a, pressure_b))
    return np.array(rows)


def test_orifice_flows_follow_the_root_of_the_pressure_drop() -> None:
    found = Plant().run(0.4 * np.sin(2.0 * np.pi * 5.0 * 1e-4 * np.arange(4000)))
    opening = found.spool_position
    for flow, extending, retracting in (
        (found.flow_a, 2.1e7 - found.pressure_a, found.pressure_a),
        (found.flow_b, found.pressure_b, 2.1e7 - found.pressure_b),
    ):
        drop = np.where(opening >= 0.0, extending, retracting)
        assert np.all(drop > TRANSITION_PRESSURE)
        assert flow == pytest.approx(2.38e-5 * opening * np.sqrt(drop), rel=1e-12)


def test_ports_let_oil_through_backwards() -> None:
    assert orifice_root(-4e6)[0] == -2e3
    assert orifice_root(4e6) == (2e3, 0.25e-3)


def test_the_root_is_smooth_through_zero_and_its_slope_is_its_derivative() -> None:
    for drop in np.linspace(-2.5, 2.5, 41) * TRANSITION_PRESSURE:
        ahead, behind = orifice_root(drop + 0.5)[0], orifice_root(drop - 0.5)[0]
        assert orifice_root(drop)[1] == pytest.approx(ahead - behind, rel=1e-3)
        assert orifice_root(-drop)[0] == -orifice_root(drop)[0]
    assert orifice_root(0.0) == (0.0, pytest.approx(1.25 * TRANSITION_PRESSURE**-0.5))


def test_trapped_oil_is_compressed_as_the_logarithm_of_its_volume() -> None:
    velocity, tau, steps = 0.1, 1e-4, 2000
    rows = oil({"internal_leakage": 0.0, "bulk_modulus": 1e9}, tau, steps, (5e8, 5e8), velocity)
    moved = velocity * tau * np.arange(1, steps + 1)
    still = 1e-5 + 645e-6 * 0.1
    assert rows[:, 0] == pytest.approx(5e8 + 1e9 * np.log(still / (still + 645e-6 * moved)), rel=1e-7)
    assert rows[:, 1] == pytest.approx(5e8 + 1e9 * np.log(still / (still - 645e-6 * moved)), rel=1e-7)


def test_leakage_evens_the_pressures_out_exponentially() -> None:
    rows = oil({"internal_leakage": 1e-11}, 2e-5, 500, (1.2e7, 8e6))
    rate = 2.0 * 1e-11 * 1.4e9 / (1e-5 + 645e-6 * 0.1)
    difference = 4e6 * np.exp(-rate * 2e-5 * np.arange(1, 501))
    assert rows[:, 0] - rows[:, 1] == pytest.approx(difference, rel=1e-4)
    assert rows.sum(axis=1) == pytest.approx(2e7, rel=1e-12)


def test_leakage_to_the_outside_empties_a_chamber_exponentially() -> None:
    rows = oil({"internal_leakage": 0.0, "external_leakage": 1e-12}, 1e-4, 500, (1.2e7, 8e6))
    rate = 1e-12 * 1.4e9 / (1e-5 + 645e-6 * 0.1)
    assert rows[:, 0] == pytest.approx(1.2e7 * np.exp(-rate * 1e-4 * np.arange(1, 501)), rel=1e-6)


@pytest.mark.parametrize("ratio", [1.0, 1e3, 1e5])
def test_leakage_of_any_strength_settles_without_overshoot(ratio: float) -> None:
    parameters = {"internal_leakage": 1e-7, "line_volume": 1e-7, "bulk_modulus": 1e10, "actuator_displacement": 1e-3}
    rows = oil(parameters, 5e-4, 50, (1.2e7, 8e6), leakage_ratio=ratio)
    assert rows[-1] == pytest.approx([1e7, 1e7], rel=1e-6)
    assert np.all(np.abs(rows - 1e7) <= 2e6)


def test_oil_is_neither_made_nor_lost() -> None:
    found = Plant({"internal_leakage": 3e-11, "external_leakage": 1e-12}, 2e-5).run(
        0.2 * np.sin(2.0 * np.pi * 4.0 * 2e-5 * np.arange(25000))
    )
    net = found.flow_a - found.internal_leakage_flow - found.external_leakage_flow_a
    volume = 1e-5 + 645e-6 * (0.1 + found.position)
    density = np.exp((found.pressure_a - found.pressure_a[0]) / 1.4e9)
    entered = np.concatenate([[0.0], np.cumsum(0.5 * (density * net)[1:] + 0.5 * (density * net)[:-1])]) * 2e-5
    stored = density * volume
    assert stored - stored[0] == pytest.approx(entered, abs=2e-5 * np.ptp(entered))
    assert found.internal_leakage_flow == pytest.approx(3e-11 * (found.pressure_a - found.pressure_b), rel=1e-12)
    assert found.external_leakage_flow_b == pytest.approx(1e-12 * found.pressure_b, rel=1e-12)
