"""The valve's closed form against transfer functions and against a brute-force integration."""

from __future__ import annotations

import numpy as np
from scipy.signal import TransferFunction, step

from eha_exam.truth import simulate_truth

RATE = 1000.0


def test_a_voltage_step_moves_coil_and_spool_as_their_transfer_functions_say() -> None:
    truth = simulate_truth({}, [], np.full(101, 0.05), 0.1)
    omega, coil = 543.0, TransferFunction([0.05], [0.59, 100.0])
    spool = TransferFunction([0.05 * omega**2], np.polymul([0.59, 100.0], [1.0, 2 * 0.48 * omega, omega**2]))
    np.testing.assert_allclose(truth["current"], step(coil, T=truth["time"])[1], atol=1e-13)
    np.testing.assert_allclose(truth["spool"], step(spool, T=truth["time"])[1], atol=1e-12)


def test_the_current_stops_at_saturation_and_returns_from_it_without_delay() -> None:
    command = np.concatenate([np.full(50, 5.0), np.full(51, -5.0)])
    current = simulate_truth({}, [], command, 0.1)["current"]
    time = np.arange(101) / RATE
    rate = 100.0 / 0.59
    rising = np.minimum(0.05 * (1.0 - np.exp(-rate * time[:51])), 0.02)
    falling = np.maximum(-0.05 + 0.07 * np.exp(-rate * (time[50:] - 0.05)), -0.02)
    np.testing.assert_allclose(current, np.concatenate([rising, falling[1:]]), atol=1e-13)


def test_hysteresis_is_a_play_between_current_and_spool() -> None:
    half_width = 2e-4
    command = 0.06 * np.sin(2.0 * np.pi * 7.0 * np.arange(301) / RATE)
    spool = simulate_truth({}, [("spool_hysteresis", {"half_width": half_width})], command, 0.3)["spool"]
    np.testing.assert_allclose(spool, brute_force_spool(command, half_width), atol=2e-7)


def brute_force_spool(command: np.ndarray, half_width: float, substeps: int = 500) -> np.ndarray:
    """Coil, play and spool in small semi-implicit Euler steps."""
    h = 1.0 / (RATE * substeps)
    current = target = spool = rate = 0.0
    samples = [spool]
    for voltage in command[:-1]:
        for _ in range(substeps):
            current += h * (voltage - 100.0 * current) / 0.59
            target = min(max(target, current - half_width), current + half_width)
            rate += h * (543.0**2 * (target - spool) - 2.0 * 0.48 * 543.0 * rate)
            spool += h * rate
        samples.append(spool)
    return np.array(samples)


def test_a_delay_shifts_the_response() -> None:
    command = 0.05 * np.sin(2.0 * np.pi * 3.0 * np.arange(301) / RATE)
    prompt = simulate_truth({}, [], command, 0.3)
    late = simulate_truth({}, [("command_delay", {"delay": 0.012})], command, 0.3)
    np.testing.assert_allclose(late["spool"][12:], prompt["spool"][:-12], atol=1e-15)
    np.testing.assert_allclose(late["position"][12:], prompt["position"][:-12], atol=1e-8)
