"""The test of a case on the truth, and what the rig's sensors recorded of it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from eha_exam.case import POSITION_NOISE, PRESSURE_NOISE, Array, Arrays, Case
from eha_exam.excitation import draw_reference, feedforward
from eha_exam.plants import Rig
from eha_exam.truth import PositionController, simulate_truth

STROKE_USED = 0.92
LOWEST_PRESSURE = -0.5e5
"""Pa. A test that takes the piston further than that share of its stroke, or draws a vacuum, is one nobody records."""
GENTLER = ((1.0, 1.0), (3.0, 1.0), (3.0, 0.6), (6.0, 0.4), (12.0, 0.25), (12.0, 0.03))
"""Centring loop [rad/s] and share of the speed with which such a test is run again."""


def simulate_case(case: Case) -> dict[str, Array]:
    """The truth's columns of a case; a test that runs to an end or draws a vacuum is run again more gently."""
    truth = _simulate(case, case.loop, 1.0)
    for loop, share in GENTLER:
        if _is_sound(case, truth):
            break
        truth = _simulate(case, max(loop, case.loop), share)
    return truth


def _is_sound(case: Case, truth: Mapping[str, Array]) -> bool:
    inside = np.max(np.abs(truth["position"])) < STROKE_USED * case.plant["actuator_displacement"]
    lowest = min(np.min(truth["pressure_a"]), np.min(truth["pressure_b"]))
    return bool(inside and lowest > LOWEST_PRESSURE)


def _simulate(case: Case, loop: float, share: float) -> dict[str, Array]:
    g = np.random.default_rng([case.seed, 1])
    rig = Rig(case.family, case.plant)
    time = np.arange(round(case.duration * case.rate) + 1) / case.rate
    reference = draw_reference(case.shape, rig, time, case.amplitude, share * case.speed, g)
    per_speed = case.plant["coil_resistance"] / rig.speed_per_ampere(1.0)
    noise = case.noise * POSITION_NOISE * g.standard_normal(len(time))
    controller = PositionController(
        reference,
        gain=loop * per_speed,
        integral_gain=case.loop_integral * per_speed,
        limit=case.plant["saturation_current"] * case.plant["coil_resistance"],
        feedforward=feedforward(rig, reference, case.rate) if case.tier != "tracking" else None,
        noise=noise,
    )
    truth = simulate_truth(case.plant, case.effects, controller, case.duration, case.rate, windows=case.windows)
    return truth | {"position_noise": noise}


def measure(case: Case, truth: Mapping[str, Array]) -> Arrays:
    """What was recorded of a truth, with the case's noise, resolution, jittered sampling and lost samples."""
    g = np.random.default_rng([case.seed, 2])
    time = truth["time"]
    arrays: Arrays = {"voltage_command": (time, truth["voltage"])}
    sensors = {
        "position": (POSITION_NOISE, case.position_step),
        "pressure_a": (PRESSURE_NOISE, case.pressure_step),
        "pressure_b": (PRESSURE_NOISE, case.pressure_step),
    }
    for channel, (level, step) in sensors.items():
        column = truth[f"measured_{channel}"]
        noise = case.noise * level * g.standard_normal(len(time))
        if channel == "position":
            noise = truth["position_noise"]
        stamps = time
        if case.jitter > 0.0:
            stamps = time + np.clip(case.jitter * g.standard_normal(len(time)), -0.3 / case.rate, 0.3 / case.rate)
            stamps = np.clip(stamps, 0.0, time[-1])
            column = CubicSpline(time, column)(stamps)
        values = column + noise
        values = np.round(values / step) * step if step > 0.0 else values
        kept = _kept(len(time), case.dropout, g)
        arrays[channel] = (stamps[kept], values[kept])
    return {channel: arrays[channel] for channel in case.channels}


def _kept(samples: int, share: float, g: np.random.Generator) -> NDArray[np.bool_]:
    """Which samples arrive: bursts of 5 to 50 are lost until the share is reached."""
    kept = np.ones(samples, dtype=bool)
    while samples - np.count_nonzero(kept) < share * samples:
        start = int(g.integers(1, samples - 51))
        kept[start : start + int(g.integers(5, 51))] = False
    return kept
