"""Recordings made from the plant itself, with noise, for tests that need to know the answer; and fits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from eha_core.diagnosis.calibrate import STEPS
from eha_core.diagnosis.characteristic_scales import Scales, characteristic_scales
from eha_core.diagnosis.hypothesis import NOTHING, Hypothesis
from eha_core.diagnosis.search.columns import Column, applicable_effects, columns_of
from eha_core.diagnosis.search.pool import Pool, Trace
from eha_core.effects import effects
from eha_core.identification.fit import Ending, Fit
from eha_core.identification.free_parameters import FreeParameter, free_nominal_parameters
from eha_core.identification.observation import Observation, observe
from eha_core.identification.problem import whole
from eha_core.identification.together import cut_together
from eha_core.parameters import nominal_values
from eha_core.plant import Plant
from eha_core.recording import Channel, Recording
from eha_core.signals import make_signal

STEP = 5e-5
LAWS = {effect.id: effect for effect in effects()}


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
    voltage: np.ndarray | None = None,
) -> Recording:
    """A multisine test of the plant with these parameters, a sine of this frequency [1/s], or a voltage [V] of one
    value a sample; noise 1 is 10 um and 0.01 MPa."""
    generator = np.random.default_rng(seed)
    every = round(1.0 / rate / STEP)
    samples = int(duration * rate)
    many = {"amplitude": amplitude, "lowest": 0.3, "highest": 8.0, "count": 16, "period": 20.0, "seed": seed}
    one = {"amplitude": amplitude, "frequency": sine}
    signal = make_signal("sine", one) if sine else make_signal("multisine", many)
    voltage = np.asarray(signal.value(np.arange(samples) / rate)) if voltage is None else voltage
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


@dataclass(frozen=True)
class Bench:
    """A recording cut into windows of one length, with the nominal equations fitted, and what could be added."""

    observation: Observation
    pool: Pool
    scales: Scales
    columns: tuple[Column, ...]

    def columns_of(self, *names: str) -> list[Column]:
        """The columns of these effects alone."""
        return [column for column in self.columns if column.effect.id in names]

    def set_of(self, *names: str) -> Hypothesis:
        """The set of these effects."""
        return NOTHING.with_effects([LAWS[name] for name in names])

    def fitted(self, values: Mapping[str, float], iterations: int = 12) -> Fit:
        """The set of the effects that have values here, fitted from these on top of the nominal values."""
        hypothesis = self.set_of(*{name.partition(".")[0] for name in values if "." in name})
        begun = {**self.pool.found[NOTHING].values, **values}
        states = self.pool.found[NOTHING].states
        return self.pool.try_set("made", hypothesis, begun, states, iterations, in_a_row=2)


def bench(
    parameters: Mapping[str, float], nominal: Mapping[str, float] | None = None, length: float = 0.1, **how: object
) -> Bench:
    """A recording of this plant, made as `recorded` does, in windows of this length [s]."""
    given = {**nominal_values(), **(nominal or {})}
    return bench_of(observe(recorded({**(nominal or {}), **parameters}, **how)), given, length)


def bench_of(observation: Observation, given: Mapping[str, float], length: float) -> Bench:
    """A recording in windows of this length [s], with these nominal values."""
    shooting = cut_together([observation], given, STEPS[0], length)
    farthest = float(np.max(np.abs(observation.channel("position").values)))
    plant = free_nominal_parameters(given, shooting.drive, farthest)
    pool = Pool(whole(shooting), plant, Trace())
    fitted = pool.try_set("nominal", NOTHING, given, None, 12)
    pool.measure_noise(NOTHING)
    scales = characteristic_scales([observation], shooting, fitted)
    columns = [column for effect in applicable_effects([observation]) for column in columns_of(effect, scales)]
    return Bench(observation, pool, scales, tuple(columns))
