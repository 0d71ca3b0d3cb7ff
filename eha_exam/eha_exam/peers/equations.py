"""The actuator's equations as linear regressions: weak form, so that no measured signal is differentiated twice.

Each equation is multiplied by smooth bumps and integrated; derivatives move to the bump. A row is one bump. The terms
of the nominal model come first and are always kept; candidates stand for effects of the catalogue.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lsim, savgol_filter

from eha_exam.errors import ExamError
from eha_exam.recordings import Arrays, read_recording
from eha_exam.truth.record import PLANT

Array = NDArray[np.float64]

RATE = 1000.0
HALF_WIDTH = 0.06
"""s, of a bump."""
HOP = 0.02
"""s, from one bump to the next."""

NEEDED = ("voltage_command", "position", "pressure_a", "pressure_b")
"""Channels that the equations are written in."""

NOMINAL = {name: value for name, value in PLANT.items() if name != "transition_pressure"}
"""What a recording is held against that has no parameters: all of the plant but what no data sheet has."""


@dataclass(frozen=True)
class Equation:
    """One weak-form regression: target = nominal @ unknowns + candidates @ sizes.

    `features` are the signals a black box may use, averaged over each bump.
    """

    site: str
    target: Array
    nominal: Array
    candidates: Array
    effects: tuple[str, ...]
    features: Array


@dataclass(frozen=True)
class Signals:
    """What a recording holds on one time axis, and what follows from it and the nominal valve."""

    time: Array
    position: Array
    velocity: Array
    pressure_a: Array
    pressure_b: Array
    spool: Array
    nominal: Mapping[str, float]


def read_signals(path: Path) -> Signals:
    """Read a recording with command, position and both pressures. ExamError where one of them is missing."""
    recording = read_recording(path)
    missing = [name for name in NEEDED if name not in recording.channels]
    if missing:
        raise ExamError(f"{path}: has no {', '.join(missing)}, which this method needs")
    return signals_of(recording.channels, recording.parameters)


def signals_of(recorded: Arrays, parameters: Mapping[str, float]) -> Signals:
    """The signals of recorded channels, all of NEEDED among them, and of the nominal `parameters` [SI]."""
    channels = [recorded[name] for name in NEEDED]
    start, stop = max(times[0] for times, _ in channels), min(times[-1] for times, _ in channels)
    time = np.arange(start, stop, 1.0 / RATE)
    voltage, position, a, b = (np.interp(time, times, values) for times, values in channels)
    times, values = channels[0]
    held = values[np.searchsorted(times, time, side="right") - 1]
    window = 2 * round(0.03 * RATE) + 1
    velocity = savgol_filter(position, window, 3, deriv=1, delta=1.0 / RATE)
    nominal = {**NOMINAL, **parameters}
    spool = _spool(time, held if len(held) else voltage, nominal)
    return Signals(time, position, velocity, a, b, spool, nominal)


def _spool(time: Array, voltage: Array, p: Mapping[str, float]) -> Array:
    """Spool position [A] that the nominal coil and spool make of the command."""
    omega = p["valve_natural_frequency"]
    denominator = np.polymul(
        [p["coil_inductance"], p["coil_resistance"]], [1.0, 2.0 * p["valve_damping_ratio"] * omega, omega**2]
    )
    return np.asarray(lsim(([omega**2], denominator), voltage, time - time[0], interp=False)[1])


def equations(s: Signals) -> list[Equation]:
    """The force balance and the chambers A and B of a recording."""
    bump, slope, curve = _bumps()
    features = np.column_stack([s.position, s.velocity, s.spool, s.pressure_a, s.pressure_b, s.time])
    averaged = _weigh(features, bump / bump.sum())
    return [_force(s, bump, slope, curve, averaged), *(_chamber(s, side, bump, slope, averaged) for side in (1, -1))]


def _bumps() -> tuple[Array, Array, Array]:
    """A bump (1 - s^2)^4 and its first and second derivative in time, sampled."""
    s = np.linspace(-1.0, 1.0, 2 * round(HALF_WIDTH * RATE) + 1)
    inside = 1.0 - s * s
    return inside**4, -8.0 * s * inside**3 / HALF_WIDTH, (48.0 * s * s * inside**2 - 8.0 * inside**3) / HALF_WIDTH**2


def _weigh(signals: Array, weight: Array) -> Array:
    """Integrals of signals (n, k) times a weight, one row for each bump."""
    length = len(weight)
    starts = np.arange(0, len(signals) - length, round(HOP * RATE))
    windows = np.lib.stride_tricks.sliding_window_view(signals, length, axis=0)[starts]
    return np.asarray(windows @ weight) / RATE


def left_over(row: Equation) -> tuple[Array, Array]:
    """What the nominal terms leave of the target (n,) and of the candidates (n, k), all of unit length."""
    stacked = np.column_stack([row.target, row.candidates])
    left = stacked - row.nominal @ np.linalg.lstsq(row.nominal, stacked, rcond=None)[0]
    left /= np.linalg.norm(left, axis=0) + 1e-300
    return left[:, 0], left[:, 1:]


def _force(s: Signals, bump: Array, slope: Array, curve: Array, features: Array) -> Equation:
    p = s.nominal
    pull = p["piston_area"] * s.pressure_a - p["piston_area_b"] * s.pressure_b
    x, v = s.position, s.velocity
    fastest = np.max(np.abs(v))
    far = np.quantile(x, 0.85)
    terms = {
        "coulomb_friction": np.tanh(v / (0.02 * fastest)),
        "stribeck_friction": np.tanh(v / (0.02 * fastest)) * np.exp(-((v / (0.1 * fastest)) ** 2)),
        "quadratic_damping": v * np.abs(v),
        "constant_load": np.ones_like(v),
        "hardening_spring": x**3,
        "end_stop": np.maximum(x - far, 0.0),
    }
    column = x[:, None]
    nominal = np.column_stack([_weigh(column, curve), -_weigh(column, slope), _weigh(column, bump)])
    candidates = _weigh(np.column_stack(list(terms.values())), bump)
    return Equation("force", _weigh(pull[:, None], bump)[:, 0], nominal, candidates, tuple(terms), features)


def _chamber(s: Signals, side: int, bump: Array, slope: Array, features: Array) -> Equation:
    """Swept volume = K orifice flow - compression / beta - leakage; side 1 is chamber A, -1 chamber B."""
    p = s.nominal
    area = p["piston_area"] if side == 1 else p["piston_area_b"]
    own = s.pressure_a if side == 1 else s.pressure_b
    supply, back = p["supply_pressure"] - own, own - p["return_pressure"]
    root = side * _root(np.where(side * s.spool > 0.0, supply, back))
    root = np.where(s.spool == 0.0, 0.0, np.abs(root))
    volume = p["line_volume"] + area * (p["actuator_displacement"] + side * s.position)
    difference = s.pressure_a - s.pressure_b
    terms = {
        "valve_null_offset": root,
        "valve_deadband": np.sign(s.spool) * root,
        "flow_gain_asymmetry": np.abs(s.spool) * root,
        "turbulent_leakage": _root(difference),
        "external_leakage": own,
        "command_delay": np.gradient(s.spool, 1.0 / RATE) * root,
        "supply_pressure_droop": s.spool * np.abs(s.spool) * root,
    }
    compression = -_weigh((own * volume)[:, None], slope) - side * _weigh((own * area * s.velocity)[:, None], bump)
    nominal = np.column_stack([_weigh((s.spool * root)[:, None], bump), compression, _weigh(difference[:, None], bump)])
    swept = -area * _weigh(s.position[:, None], slope)[:, 0]
    candidates = _weigh(np.column_stack(list(terms.values())), bump)
    return Equation("chamber", swept, nominal, candidates, tuple(terms), features)


def _root(drop: Array) -> Array:
    return np.asarray(np.sign(drop) * np.sqrt(np.abs(drop)))
