"""Test benches with a known law: a motion, and the force that the law asks for, written apart from the library."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from eha_core.motion_given import Motion, motion_of
from eha_core.recording import Recording

RATE = 500.0
TIME = np.arange(round(12.0 * RATE)) / RATE


def position(time: np.ndarray) -> np.ndarray:
    """Two sines that no period of the recording repeats [m]."""
    return 0.02 * np.sin(2.0 * np.pi * 0.7 * time) + 0.006 * np.sin(2.0 * np.pi * 1.9 * time + 1.0)


def velocity(time: np.ndarray) -> np.ndarray:
    slow = 0.02 * 2.0 * np.pi * 0.7 * np.cos(2.0 * np.pi * 0.7 * time)
    return slow + 0.006 * 2.0 * np.pi * 1.9 * np.cos(2.0 * np.pi * 1.9 * time + 1.0)


def recording(force: np.ndarray, noise: float = 2.0, seed: int = 3, **channels: np.ndarray) -> Recording:
    """A recording of position (0.2 um of noise) and force."""
    generator = np.random.default_rng(seed)
    return Recording.from_arrays(
        time=TIME,
        pressures="gauge",
        name="bench",
        position=position(TIME) + 2e-7 * generator.standard_normal(len(TIME)),
        force=force + noise * generator.standard_normal(len(TIME)),
        **channels,
    )


def motion(force: np.ndarray, **options: object) -> Motion:
    return motion_of(recording(force, **options))  # type: ignore[arg-type]


def bouc_wen(height: float, distance: float, creep: float) -> np.ndarray:
    """Friction of Bouc and Wen's law with n = 1 that creeps, by SciPy's integrator."""

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        speed = velocity(np.array([time]))[0]
        return np.array([abs(speed) / distance * (speed / np.hypot(speed, creep) - state[0])])

    solution = solve_ivp(rate, (0.0, TIME[-1]), [0.0], "LSODA", TIME, rtol=1e-8, atol=1e-8, max_step=5e-3)
    assert solution.success
    return np.asarray(height * solution.y[0])
