"""Recordings made from the plant itself, with noise, for tests that need to know the answer; and fits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from eha_core.identification.fit import Ending, Fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.parameters import nominal_values
from eha_core.plant import Plant
from eha_core.recording import Channel, Recording
from eha_core.signals import make_signal

STEP = 5e-5


def recorded(
    parameters: Mapping[str, float],
    *,
    seed: int = 1,
    duration: float = 10.0,
    rate: float = 500.0,
    noise: float = 1.0,
    amplitude: float = 0.12,
    channels: tuple[str, ...] = ("voltage_command", "position", "pressure_a", "pressure_b"),
    sine: float = 0.0,
) -> Recording:
    """A multisine test of the plant with these parameters, or a sine of this frequency [1/s]; noise 1 is 10 um and
    0.01 MPa."""
    generator = np.random.default_rng(seed)
    every = round(1.0 / rate / STEP)
    samples = int(duration * rate)
    many = {"amplitude": amplitude, "lowest": 0.3, "highest": 8.0, "count": 16, "period": 20.0, "seed": seed}
    one = {"amplitude": amplitude, "frequency": sine}
    signal = make_signal("sine", one) if sine else make_signal("multisine", many)
    voltage = np.asarray(signal.value(np.arange(samples) / rate))
    rows = Plant(parameters, STEP).run(np.repeat(voltage, every), every)
    clean = {
        "voltage_command": (np.arange(samples) / rate, voltage, 0.0, "V"),
        "position": (rows.time, rows.measured_position, 1e-5, "m"),
        "pressure_a": (rows.time, rows.measured_pressure_a, 1e4, "Pa"),
        "pressure_b": (rows.time, rows.measured_pressure_b, 1e4, "Pa"),
    }
    made = {
        name: Channel(name, time, values + noise * level * generator.standard_normal(len(values)), unit, name, "made")
        for name, (time, values, level, unit) in clean.items()
        if name in channels
    }
    return Recording(Path("made.mcap"), made, 0, duration, {}, (), None, ())


def explanation(changes: Mapping[str, float], free: Sequence[FreeParameter] = ()) -> Fit:
    """A fit as the comparison hands it over, of a plant with these parameters."""
    values = {**nominal_values(), **changes}
    n = len(free)
    q = np.array([one.coordinate(values[one.name]) for one in free])
    return Fit(tuple(free), q, values, np.zeros((1, 4)), 0.0, 0.0, 1, (), np.eye(n), Ending.CONVERGED, 0)
