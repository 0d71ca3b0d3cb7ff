"""The axis of the court against closed forms, and its values found again from a recording made apart from it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eha_core.known_answers.real.axis import Axis, Windows, fit_axis, from_fitted_starts, rms, simulate

PERIOD = 1e-3
AXIS = Axis(mass=95.0, forward=155.0, backward=235.0, friction=20.0)


def test_it_sticks_below_its_friction_and_slides_as_the_closed_form_says() -> None:
    held = simulate(AXIS, np.full((1, 500), 0.9 * AXIS.friction), np.zeros(1), np.zeros(1), PERIOD)
    assert np.all(held == 0.0)
    for force, damping in ((80.0, AXIS.forward), (-80.0, AXIS.backward)):
        time = PERIOD * np.arange(1000)
        net = np.sign(force) * (abs(force) - AXIS.friction)
        settling = AXIS.mass / damping
        slide = net / damping * (time - settling * (1.0 - np.exp(-time / settling)))
        found = simulate(AXIS, np.full((1, 1000), force), np.zeros(1), np.zeros(1), PERIOD)[0]
        assert np.max(np.abs(found - slide)) < 2e-3 * abs(slide[-1])


@pytest.fixture(scope="module")
def recording() -> Windows:
    """10 s of the axis by SciPy, its dry friction rounded over 0.01 mm/s."""
    time = PERIOD * np.arange(10001)

    def force(at: float) -> float:
        return 90.0 * np.sin(2.0 * np.pi * 0.5 * at) + 40.0 * np.sin(2.0 * np.pi * 1.3 * at)

    def rates(at: float, state: np.ndarray) -> list[float]:
        damping = AXIS.forward if state[1] > 0.0 else AXIS.backward
        rub = AXIS.friction * np.tanh(state[1] / 1e-5)
        return [state[1], (force(at) - damping * state[1] - rub) / AXIS.mass]

    found = solve_ivp(rates, (0.0, 10.0), [0.0, 0.0], "LSODA", time, rtol=1e-8, atol=1e-10, max_step=1e-2)
    return Windows.cut(np.array([force(at + 0.5 * PERIOD) for at in time]), found.y[0], PERIOD, 0.25)


def test_values_are_found_again_and_a_load_does_not_do(recording: Windows) -> None:
    start = Axis(100.0, 200.0, 200.0, 15.0)
    found = fit_axis(start, [recording], with_load=False)
    assert found.mass == pytest.approx(AXIS.mass, rel=0.01)
    assert found.forward == pytest.approx(AXIS.forward, rel=0.02)
    assert found.backward == pytest.approx(AXIS.backward, rel=0.02)
    assert found.friction == pytest.approx(AXIS.friction, rel=0.02)
    rival = fit_axis(start, [recording], with_load=True)
    assert rms(from_fitted_starts(rival, recording)) > 5.0 * rms(from_fitted_starts(found, recording))


def test_a_steady_slide_needs_the_dry_friction_of_its_speed_and_the_viscous_part() -> None:
    """A steady slide: the force is dry friction at that speed and the viscous part."""
    axis = Axis(mass=95.0, forward=155.0, backward=235.0, friction=7.0, rise=12.0, stribeck_velocity=0.1)
    held = simulate(axis, np.full((1, 500), 18.9), np.zeros(1), np.zeros(1), PERIOD)
    assert np.all(held == 0.0)
    speed = 0.05
    force = 7.0 + 12.0 * np.exp(-0.25) + 155.0 * speed
    found = simulate(axis, np.full((1, 100), force), np.zeros(1), np.full(1, speed), PERIOD)[0]
    np.testing.assert_allclose(np.diff(found), speed * PERIOD, rtol=1e-9)
