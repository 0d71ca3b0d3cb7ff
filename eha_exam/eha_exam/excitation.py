"""Test signals: references of position that use the stroke and the valve well, and the voltages that follow them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eha_exam.plants import Rig

Array = NDArray[np.float64]

SHAPES = ("multisine", "chirp", "steps", "triangle")


def draw_reference(
    shape: str, rig: Rig, time: Array, amplitude: float, speed: float, generator: np.random.Generator
) -> Array:
    """A reference of position [m] about mid stroke: at most `amplitude` [m] and `speed` [m/s], at rest at the start.

    multisine: eight sines, 0.1 to 6 Hz, amplitude falling with frequency; chirp: constant peak speed, 0.1 to 8 Hz and
    back; steps: smooth moves with dwells; triangle: slow ramps with dwells and small fast sines on them.
    """
    draw = {"multisine": _multisine, "chirp": _chirp, "steps": _steps, "triangle": _triangle}[shape]
    raw = draw(time, amplitude, speed, generator)
    raw *= np.clip(time / 0.5, 0.0, 1.0) ** 2 * (3.0 - 2.0 * np.clip(time / 0.5, 0.0, 1.0))
    peak_speed = np.max(np.abs(np.gradient(raw, time)))
    return np.asarray(raw * min(1.0, amplitude / np.max(np.abs(raw)), speed / peak_speed))


def _multisine(time: Array, amplitude: float, speed: float, generator: np.random.Generator) -> Array:
    frequencies = 0.1 * 60.0 ** (np.arange(8) / 7.0) * generator.uniform(0.9, 1.1, 8)
    phases = generator.uniform(0.0, 2.0 * np.pi, 8)
    wave = sum(np.sin(2.0 * np.pi * f * time + p) / f**0.8 for f, p in zip(frequencies, phases, strict=True))
    wave = wave - wave[0]
    return np.asarray(wave * amplitude / np.max(np.abs(wave)))


def _chirp(time: Array, amplitude: float, speed: float, generator: np.random.Generator) -> Array:
    half = time[-1] / 2.0
    progress = 1.0 - np.abs(time / half - 1.0)
    frequency = generator.uniform(0.1, 0.3) * 40.0**progress
    phase = 2.0 * np.pi * np.concatenate([[0.0], np.cumsum(frequency[:-1] * np.diff(time))])
    size = np.minimum(amplitude, speed / (2.0 * np.pi * frequency))
    return np.asarray(size * np.sin(phase))


def _steps(time: Array, amplitude: float, speed: float, generator: np.random.Generator) -> Array:
    reference = np.zeros_like(time)
    here, now = 0.0, 0.3
    while now < time[-1]:
        there = generator.uniform(-amplitude, amplitude)
        move = max(1.9 * abs(there - here) / (speed * generator.uniform(0.3, 1.0)), 0.08)
        s = np.clip((time - now) / move, 0.0, 1.0)
        reference += (there - here) * s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
        here, now = there, now + move + generator.uniform(0.05, 0.6)
    return reference


def _triangle(time: Array, amplitude: float, speed: float, generator: np.random.Generator) -> Array:
    reference = np.zeros_like(time)
    here, now, side = 0.0, 0.3, 1.0
    while now < time[-1]:
        there = side * amplitude * generator.uniform(0.4, 1.0)
        move = abs(there - here) / (speed * generator.uniform(0.15, 0.8))
        reference += (there - here) * np.clip((time - now) / move, 0.0, 1.0)
        here, now, side = there, now + move + generator.uniform(0.1, 0.5), -side
    ripple = 0.1 * speed / (2.0 * np.pi * 5.0) * np.sin(2.0 * np.pi * generator.uniform(3.0, 7.0) * time)
    return reference + ripple


def feedforward(rig: Rig, reference: Array, rate: float) -> Array:
    """The voltage [V] at which the unloaded rig follows the reference."""
    speed = np.gradient(reference, 1.0 / rate)
    spool = np.where(speed > 0.0, speed / rig.speed_per_ampere(1.0), speed / rig.speed_per_ampere(-1.0))
    return np.asarray(rig.values["coil_resistance"] * spool)
