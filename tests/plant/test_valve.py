"""Coil and spool, equations (1) and (2), against their closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.plant import Plant


def spool_response(time: np.ndarray, voltage: float, rate: float, damping_ratio: float, frequency: float) -> np.ndarray:
    """Step response of 100 ohm, the coil's lag and the spool in series, by partial fractions."""
    root = np.sqrt(complex(damping_ratio**2 - 1.0))
    poles = np.array([-rate, frequency * (-damping_ratio + root), frequency * (-damping_ratio - root)])
    response = np.ones_like(time, dtype=complex)
    for k, pole in enumerate(poles):
        others = np.delete(poles, k)
        response += rate * frequency**2 / (pole * np.prod(pole - others)) * np.exp(pole * time)
    return voltage / 100.0 * response.real


@pytest.mark.parametrize("step_size", [1e-5, 1e-4, 1e-3])
@pytest.mark.parametrize("damping_ratio", [0.48, 2.0])
def test_step_response_is_exact_at_any_step(step_size: float, damping_ratio: float) -> None:
    plant = Plant({"valve_damping_ratio": damping_ratio}, step_size)
    found = plant.run(np.full(round(0.05 / step_size), 0.01))
    assert found.current == pytest.approx(1e-4 * -np.expm1(-100.0 / 0.59 * found.time), rel=1e-10)
    expected = spool_response(found.time, 0.01, 100.0 / 0.59, damping_ratio, 543.0)
    assert np.max(np.abs(found.spool_position - expected)) < 1e-15


def test_current_saturates_and_leaves_saturation_at_once() -> None:
    plant = Plant()
    rate, time = 100.0 / 0.59, np.log(2.0) * 0.59 / 100.0
    full = plant.run(np.full(200, 4.0))
    reached = full.time[np.argmax(full.current == 0.02)]
    assert reached == pytest.approx(time, abs=1e-4)  # 4 V drive 40 mA, of which half is reached after ln 2 / rate
    assert np.max(full.current) == 0.02
    back = plant.run(np.zeros(50))
    assert back.current == pytest.approx(0.02 * np.exp(-rate * 1e-4 * np.arange(1, 51)), rel=1e-12)


def test_spool_velocity_is_the_spool_positions_derivative() -> None:
    found = Plant(step_size=1e-5).run(np.full(2000, 0.05))
    slope = np.gradient(found.spool_position, found.time)
    assert found.spool_velocity[5:-5] == pytest.approx(slope[5:-5], abs=1e-4 * np.max(np.abs(slope)))
