"""Equations (1) to (10) at Table 1's values as a right-hand side, compiled by numba, for integrators of other houses.

Dry friction and the stroke's ends, which the plant takes as they are, must have a slope for an integrator of ordinary
differential equations: friction follows tanh(v / width), and the ends are springs with a damper.
"""

from __future__ import annotations

from math import exp, pi, sin, sqrt, tanh
from typing import NamedTuple

import numba
import numpy as np
from numba import types
from numpy.typing import NDArray

Array = NDArray[np.float64]

SCALES = np.array([1e-4, 1e-4, 1e-2, 1e-3, 1e-2, 1e7, 1e7])
"""Sizes of current, spool position and velocity, piston position and velocity, and pressures, for tolerances."""

STROKE = 0.1


class Setting(NamedTuple):
    """What the right-hand side is given: the voltage, held or a sine [V, Hz]; friction [N, N, m/s] over a width [m/s];
    the ends' stiffness [N/m] and damping [N s/m]."""

    held: float = 0.0
    amplitude: float = 0.0
    frequency: float = 0.0
    sliding: float = 0.0
    static: float = 0.0
    stribeck_velocity: float = 1.0
    width: float = 1.0
    stiffness: float = 0.0
    damping: float = 0.0


def start(position: float) -> Array:
    """The state at rest: current, spool position and velocity, piston position and velocity, both pressures."""
    return np.array([0.0, 0.0, 0.0, position, 0.0, 1.05e7, 1.05e7])


@numba.njit(error_model="numpy")
def _signed_root(difference: float) -> float:
    return sqrt(difference) if difference >= 0.0 else -sqrt(-difference)


@numba.njit(error_model="numpy")
def rate(time: float, state: Array, out: Array, setting: Array) -> None:
    """Write the state's rate into `out`; `setting` is a `Setting` as an array."""
    current, spool, spool_rate, position, velocity, pressure_a, pressure_b = state
    held, amplitude, frequency, sliding, static, stribeck_velocity, width, stiffness, damping = setting
    voltage = held + amplitude * sin(2.0 * pi * frequency * time) if amplitude else held
    if spool >= 0.0:
        flow_a = 2.38e-5 * spool * _signed_root(2.1e7 - pressure_a)
        flow_b = 2.38e-5 * spool * _signed_root(pressure_b)
    else:
        flow_a = 2.38e-5 * spool * _signed_root(pressure_a)
        flow_b = 2.38e-5 * spool * _signed_root(2.1e7 - pressure_b)
    past_the_seal = 1e-12 * (pressure_a - pressure_b)
    swept = 645e-6 * velocity
    force = 645e-6 * (pressure_a - pressure_b) - 2000.0 * velocity - 10.0 * position
    if sliding + static > 0.0:
        share = velocity / stribeck_velocity
        force -= (sliding + (static - sliding) * exp(-share * share)) * tanh(velocity / width)
    beyond = abs(position) - STROKE
    if stiffness > 0.0 and beyond > 0.0:
        outwards = 1.0 if position > 0.0 else -1.0
        force -= outwards * max(0.0, stiffness * beyond + damping * outwards * velocity)
    out[0] = (voltage - 100.0 * current) / 0.59
    out[1] = spool_rate
    out[2] = 543.0**2 * (current - spool) - 2.0 * 0.48 * 543.0 * spool_rate
    out[3] = velocity
    out[4] = force / 9.0
    out[5] = 1.4e9 / (1e-5 + 645e-6 * (STROKE + position)) * (flow_a - past_the_seal - swept)
    out[6] = 1.4e9 / (1e-5 + 645e-6 * (STROKE - position)) * (swept - flow_b + past_the_seal)


@numba.njit(error_model="numpy")
def odeint_rate(time: float, state: Array, setting: Array) -> Array:
    """`rate` as SciPy calls it."""
    out = np.empty(7)
    rate(time, state, out, setting)
    return out


@numba.njit(error_model="numpy")
def rk4(state: Array, voltages: Array, hold: float, steps: int, setting: Array) -> Array:
    """Classical RK4 with so many steps a hold; the states (n, 7) at each hold's end."""
    rows = np.empty((len(voltages), 7))
    state, setting, between = state.copy(), setting.copy(), np.empty(7)
    first, second, third, fourth = np.empty(7), np.empty(7), np.empty(7), np.empty(7)
    step = hold / steps
    for k in range(len(voltages)):
        setting[0] = voltages[k]
        for part in range(steps):
            time = k * hold + part * step
            rate(time, state, first, setting)
            for j in range(7):
                between[j] = state[j] + 0.5 * step * first[j]
            rate(time + 0.5 * step, between, second, setting)
            for j in range(7):
                between[j] = state[j] + 0.5 * step * second[j]
            rate(time + 0.5 * step, between, third, setting)
            for j in range(7):
                between[j] = state[j] + step * third[j]
            rate(time + step, between, fourth, setting)
            for j in range(7):
                state[j] += step / 6.0 * (first[j] + 2.0 * (second[j] + third[j]) + fourth[j])
        rows[k] = state
    return rows


_VECTOR = types.CPointer(types.CPointer(types.CPointer(types.float64)))
"""SUNDIALS' N_Vector: a pointer to its content, whose second word points at the numbers where indices have 32 bits."""


@numba.cfunc(types.int32(types.float64, _VECTOR, _VECTOR, types.CPointer(types.float64)), error_model="numpy")
def cvode_rate(time, state, out, setting):  # type: ignore[no-untyped-def]
    """`rate` as CVODE calls it."""
    rate(time, numba.carray(state[0][1], (7,)), numba.carray(out[0][1], (7,)), numba.carray(setting, (9,)))
    return 0
