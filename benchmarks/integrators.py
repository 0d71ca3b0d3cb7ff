"""The plant against SciPy's LSODA at equal accuracy, both judged by a much tighter integration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from math import pi, sin, sqrt
from time import perf_counter
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import odeint, solve_ivp

from benchmarks.row import Row
from eha_core.plant import Plant

DURATION = 2.0
HOLD = 2e-3  # s; a controller at 500 Hz, and the spacing of the compared instants
POSITION_TOLERANCE, PRESSURE_TOLERANCE = 1e-6, 100.0
STEP_SIZES = (1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5)
RELATIVE_TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
ROUNDS = 5
TARGET = 100.0

Array = NDArray[np.float64]
Run = Callable[[float], Array]
Integrate = Callable[[Any, Array, Array, float, tuple[float, ...]], Array]
Rate = Any  # a compiled function, which carries no type
SCALES = np.array([1e-4, 1e-4, 1e-2, 1e-3, 1e-2, 1e7, 1e7])
"""Sizes of current, spool position and velocity, piston position and velocity, and pressures, for tolerances."""
START = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.05e7, 1.05e7])
OBSERVED = (3, 5, 6)
"""Where piston position and pressures stand in the state."""


@dataclass(frozen=True)
class Sufficient:
    """The cheapest setting of a method that meets both tolerances, and the time of one run [s]."""

    setting: float
    seconds: float


def measure() -> list[Row]:
    """Find the cheapest sufficient setting of each method and compare their times, under two commands.

    SciPy has two ways to LSODA, a class for solve_ivp and the older odeint, whose loop is compiled; both are peers.
    """
    held, sine = _reference_held(), _reference_sine()
    plant_held, plant_sine = (_cheapest(_plant_held, STEP_SIZES, held), _cheapest(_plant_sine, STEP_SIZES, sine))
    rows = []
    for peer, integrate in (("solve_ivp(method='LSODA')", _solve_ivp_lsoda), ("odeint", _odeint)):
        lsoda_held = _cheapest(partial(_lsoda_held, integrate), RELATIVE_TOLERANCES, held)
        lsoda_sine = _cheapest(partial(_lsoda_sine, integrate), RELATIVE_TOLERANCES, sine)
        rows.append(_row("a controller's command, held for 2 ms each", peer, plant_held, lsoda_held))
        rows.append(_row("a smooth 1 Hz sine", peer, plant_sine, lsoda_sine))
    return rows


def _row(command: str, peer: str, plant: Sufficient, lsoda: Sufficient) -> Row:
    factor = lsoda.seconds / plant.seconds
    return Row(
        f"{DURATION:g} s under {command}, within 1e-6 m and 100 Pa",
        f"{plant.seconds * 1e3:.2f} ms at a step of {plant.setting:g} s",
        f"SciPy's {peer}, compiled right-hand side: {lsoda.seconds * 1e3:.1f} ms at rtol {lsoda.setting:g}",
        f"{factor:,.3g} x faster" if factor < 1000 else f"{factor:,.0f} x faster",
        f">= {TARGET:g} x",
        factor >= TARGET,
    )


def _cheapest(run: Run, settings: tuple[float, ...], reference: Array) -> Sufficient:
    """Return the fastest of the settings that meet both tolerances; looser ones are not always faster."""
    sufficient = []
    for setting in settings:
        worst = np.max(np.abs(run(setting) - reference), axis=1)
        if worst[0] <= POSITION_TOLERANCE and max(worst[1:]) <= PRESSURE_TOLERANCE:
            sufficient.append(Sufficient(setting, min(_seconds(run, setting) for _ in range(2))))
    best = min(sufficient, key=lambda one: one.seconds)
    return Sufficient(best.setting, min(_seconds(run, best.setting) for _ in range(ROUNDS)))


def _seconds(run: Run, setting: float) -> float:
    start = perf_counter()
    run(setting)
    return perf_counter() - start


def _sine(times: Any) -> Array:
    return np.asarray(8.4e-3 * np.sin(2.0 * pi * times))


def _held_voltages() -> Array:
    """Three sines, none a multiple of another, sampled as a controller would."""
    times = HOLD * np.arange(round(DURATION / HOLD))
    parts = ((12e-3, 1.3), (8e-3, 7.1), (4e-3, 23.7))  # V, Hz
    return np.asarray(sum(amplitude * np.sin(2.0 * pi * frequency * times) for amplitude, frequency in parts))


def _plant_held(step: float) -> Array:
    every = round(HOLD / step)
    return _plant(np.repeat(_held_voltages(), every), step)


def _plant_sine(step: float) -> Array:
    # The held voltage is the sine at the middle of its step.
    return _plant(_sine(step * (np.arange(round(DURATION / step)) + 0.5)), step)


def _plant(voltages: Array, step: float) -> Array:
    plant = _at_rest(step)
    plant.reset()
    trajectory = plant.run(voltages, round(HOLD / step))
    return np.array([trajectory.position, trajectory.pressure_a, trajectory.pressure_b])


@cache
def _at_rest(step: float) -> Plant:
    """Return the plant of a step size; setting it up is not part of a run."""
    return Plant(step_size=step)


def _lsoda_sine(integrate: Integrate, tolerance: float) -> Array:
    times = np.linspace(0.0, DURATION, round(DURATION / HOLD) + 1)
    return integrate(_sine_rate, START, times, tolerance, ())[1:, OBSERVED].T


def _lsoda_held(integrate: Integrate, tolerance: float) -> Array:
    """Start LSODA anew at each jump of the voltage, as its manual advises."""
    state, rows = START, []
    for voltage in _held_voltages():
        state = integrate(_rate, state, np.array([0.0, HOLD]), tolerance, (voltage,))[-1]
        rows.append(state[[*OBSERVED]])
    return np.array(rows).T


def _solve_ivp_lsoda(rate: Rate, start: Array, times: Array, tolerance: float, arguments: tuple[float, ...]) -> Array:
    """Return the states (n, 7) at the times, the start among them."""
    options: dict[str, Any] = {"rtol": tolerance, "atol": tolerance * SCALES, "t_eval": times, "args": arguments}
    return np.asarray(solve_ivp(rate, (0.0, times[-1]), start, method="LSODA", **options).y.T)


def _odeint(rate: Rate, start: Array, times: Array, tolerance: float, arguments: tuple[float, ...]) -> Array:
    """Return the states (n, 7) at the times, the start among them."""
    options: dict[str, Any] = {"rtol": tolerance, "atol": tolerance * SCALES, "mxstep": 100_000}
    return np.asarray(odeint(rate, start, times, args=arguments, tfirst=True, **options))


def _reference_sine() -> Array:
    times = np.linspace(0.0, DURATION, round(DURATION / HOLD) + 1)[1:]
    return _reference(_sine_rate, START, times, ())[OBSERVED, :]


def _reference_held() -> Array:
    state, rows = START, []
    for voltage in _held_voltages():
        state = _reference(_rate, state, np.array([HOLD]), (voltage,))[:, -1]
        rows.append(state[[*OBSERVED]])
    return np.array(rows).T


def _reference(rate: Rate, start: Array, times: Array, arguments: tuple[float, ...]) -> Array:
    options: dict[str, Any] = {"rtol": 1e-10, "atol": 1e-10 * SCALES, "t_eval": times, "args": arguments}
    return np.asarray(solve_ivp(rate, (0.0, times[-1]), start, method="DOP853", **options).y)


@numba.njit(error_model="numpy")
def _signed_root(difference: float) -> float:
    return sqrt(difference) if difference >= 0.0 else -sqrt(-difference)


@numba.njit(error_model="numpy")
def _rate(time: float, state: Array, voltage: float) -> Array:
    """Equations (1) to (10) at Table 1's values."""
    current, spool, spool_rate, position, velocity, pressure_a, pressure_b = state
    if spool >= 0.0:
        flow_a = 2.38e-5 * spool * _signed_root(2.1e7 - pressure_a)
        flow_b = 2.38e-5 * spool * _signed_root(pressure_b)
    else:
        flow_a = 2.38e-5 * spool * _signed_root(pressure_a)
        flow_b = 2.38e-5 * spool * _signed_root(2.1e7 - pressure_b)
    past_the_seal = 1e-12 * (pressure_a - pressure_b)
    swept = 645e-6 * velocity
    rate = np.empty(7)
    rate[0] = (voltage - 100.0 * current) / 0.59
    rate[1] = spool_rate
    rate[2] = 543.0**2 * (current - spool) - 2.0 * 0.48 * 543.0 * spool_rate
    rate[3] = velocity
    rate[4] = (645e-6 * (pressure_a - pressure_b) - 2000.0 * velocity - 10.0 * position) / 9.0
    rate[5] = 1.4e9 / (1e-5 + 645e-6 * (0.1 + position)) * (flow_a - past_the_seal - swept)
    rate[6] = 1.4e9 / (1e-5 + 645e-6 * (0.1 - position)) * (swept - flow_b + past_the_seal)
    return rate


@numba.njit(error_model="numpy")
def _sine_rate(time: float, state: Array) -> Array:
    return _rate(time, state, 8.4e-3 * sin(2.0 * pi * time))
