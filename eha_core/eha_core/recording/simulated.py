"""Simulates the actuator faster than real time and records it with the simulator node's topics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from heapq import merge
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import ParameterError
from eha_core.plant import COLUMNS, PAPER, Composition, Plant, simulate_many
from eha_core.recording.channel_kinds import FloatArray
from eha_core.recording.message_rows import encode_rows
from eha_core.recording.message_types import encode
from eha_core.recording.writer import OfferedQuality, RecordingWriter

FLOAT, JOINTS = "std_msgs/msg/Float64", "sensor_msgs/msg/JointState"
PRESSURE, STATE = "sensor_msgs/msg/FluidPressure", "eha_interfaces/msg/ActuatorState"
PARAMETER_EVENT = "rcl_interfaces/msg/ParameterEvent"
_DOUBLE = 3  # rcl_interfaces/msg/ParameterType
_LATCHED = OfferedQuality(durability="transient_local", depth=1)
_NANOSECONDS = 1_000_000_000
_BLOCK = 10_000  # messages serialised at once

HELD = ("voltage_command",)
"""Channels that hold between their samples; others are interpolated."""

POSITION_NOISE = 10e-6
"""Standard deviation at noise 1 [m]."""
PRESSURE_NOISE = 1e4
"""Standard deviation at noise 1 [Pa]."""
VELOCITY_NOISE = 1e-3
"""Standard deviation at noise 1 [m/s]; assumed."""


@dataclass(frozen=True)
class Experiment:
    """An experiment to simulate.

    Attributes:
        command_times: instants from which each voltage holds, increasing [s]; before the first the voltage is zero.
        voltages: the voltages [V].
        duration: simulated time [s].
        parameters: the rig's parameters that differ from nominal ones.
        changes: (instant [s], parameter, value), applied at the first publishing instant from then on.
        step_size: the plant's step [s].
        rate: publishing rate [Hz]; a period must be a whole number of steps.
        noise: sensor noise as a multiple of POSITION_NOISE, VELOCITY_NOISE and PRESSURE_NOISE.
        seed: seed of the noise.
        initial_position: of the piston [m].
        composition: the actuator's parts.
        inputs: of a source that no voltage drives, (times [s], values [SI]) of each of its channels.
    """

    command_times: FloatArray
    voltages: FloatArray
    duration: float
    parameters: Mapping[str, float] = field(default_factory=dict)
    changes: Sequence[tuple[float, str, float]] = ()
    step_size: float = 1e-4
    rate: float = 500.0
    noise: float = 0.0
    seed: int = 1
    initial_position: float = 0.0
    composition: Composition = PAPER
    inputs: Mapping[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict)

    @property
    def steps_per_period(self) -> int:
        """Plant steps between two published states; raises ParameterError where that is not a whole number."""
        steps = 1.0 / (self.rate * self.step_size)
        if steps < 0.5 or abs(steps - round(steps)) > 1e-6 * steps:
            raise ParameterError(
                f"rate {self.rate:g} Hz: its period is {steps:g} steps of {self.step_size:g} s; choose a whole number"
            )
        return round(steps)

    @property
    def periods(self) -> int:
        """Publishing periods in the whole record."""
        return round(self.duration * self.rate)


@dataclass(frozen=True)
class Simulated:
    """A simulated record.

    Attributes:
        stamps: instants of the rows, from 0 on [ns].
        states: one row for each stamp, with the plant's COLUMNS; noise is in the measured ones.
        commands: (stamp [ns], voltage [V]) of each command.
        parameters: every parameter in force at the start.
        changes: (stamp [ns], parameter, value).
        composition: the actuator's parts.
        inputs: (stamps [ns], values) of each channel that drove it, where no voltage did.
    """

    stamps: NDArray[np.int64]
    states: FloatArray
    commands: tuple[NDArray[np.int64], FloatArray]
    parameters: Mapping[str, float]
    changes: Sequence[tuple[int, str, float]]
    composition: Composition = PAPER
    inputs: Mapping[str, tuple[NDArray[np.int64], FloatArray]] = field(default_factory=dict)

    @property
    def atmosphere(self) -> float:
        """Absolute pressure of the return line's reference [Pa]."""
        return self.composition.places(self.parameters)["atmospheric_pressure"]

    def column(self, name: str) -> FloatArray:
        """One of COLUMNS over all rows."""
        return self.states[:, COLUMNS.index(name)]


def simulate(experiment: Experiment) -> Simulated:
    """Run an experiment, far faster than real time.

    Raises:
        ParameterError: a parameter, a change or the rate is wrong.
    """
    plant = Plant(experiment.parameters, experiment.step_size, experiment.initial_position, experiment.composition)
    every, periods = experiment.steps_per_period, experiment.periods
    parameters = dict(plant.parameters)
    driving = _driving(experiment)
    changes = [
        (int(np.ceil(time * experiment.rate - 1e-6)), name, value)
        for time, name, value in sorted(experiment.changes, key=lambda change: change[0])
    ]
    pieces = [np.array([plant.state])]
    bounds = sorted({0, periods, *(min(period, periods) for period, _, _ in changes)})
    for start, end in zip(bounds, bounds[1:], strict=False):
        plant.set_parameters({name: value for period, name, value in changes if period == start})
        pieces.append(plant.run(driving[start * every : end * every], every).values)
    made = [(start, name, value) for start, name, value in changes if start < periods]
    return _recorded(experiment, np.concatenate(pieces), parameters, made)


def simulate_sweep(experiment: Experiment, name: str, values: Sequence[float]) -> list[Simulated]:
    """Run an experiment once for each value of a parameter, all in lock-step.

    Raises:
        ParameterError: as `simulate`, and where the experiment changes a parameter while it runs.
    """
    if experiment.changes:
        raise ParameterError("a sweep changes nothing on its way; give every parameter from the start, without @S")
    sets = [{**experiment.parameters, name: value} for value in values]
    plants = [
        Plant(parameters, experiment.step_size, experiment.initial_position, experiment.composition)
        for parameters in sets
    ]
    run = simulate_many(
        sets, _driving(experiment), step_size=experiment.step_size, every=experiment.steps_per_period,
        initial_position=experiment.initial_position, composition=experiment.composition,
    )  # fmt: skip
    return [
        _recorded(experiment, np.concatenate([[plant.state], rows]), dict(plant.parameters), [])
        for plant, rows in zip(plants, run.values, strict=True)
    ]


def _first_steps(experiment: Experiment) -> NDArray[np.int64]:
    """The first step of each command."""
    return np.ceil(experiment.command_times / experiment.step_size - 1e-6).astype(np.int64)


def _driving(experiment: Experiment) -> FloatArray:
    """The source's input in each step: (steps,) voltages, or (steps, inputs) of the measured channels, at mid-step."""
    if not experiment.inputs:
        return _held_voltages(experiment)
    steps = np.arange(experiment.periods * experiment.steps_per_period)
    columns = []
    for name, (time, values) in experiment.inputs.items():
        if name in HELD:
            latest = np.searchsorted(time, steps * experiment.step_size + 1e-9, side="right") - 1
            columns.append(np.where(latest >= 0, values[latest], 0.0))
        else:
            columns.append(np.interp((steps + 0.5) * experiment.step_size, time, values))
    return np.stack(columns, axis=1)


def _held_voltages(experiment: Experiment) -> FloatArray:
    """The voltage of each step."""
    steps = np.arange(experiment.periods * experiment.steps_per_period)
    latest = np.searchsorted(_first_steps(experiment), steps, side="right") - 1
    return np.where(latest >= 0, experiment.voltages[latest], 0.0)


def _recorded(
    experiment: Experiment,
    states: FloatArray,
    parameters: Mapping[str, float],
    changes: Sequence[tuple[int, str, float]],
) -> Simulated:
    """The record of the plant's rows; `changes` are (period, parameter, value)."""
    _add_noise(states, experiment)
    period = experiment.steps_per_period * experiment.step_size * _NANOSECONDS
    first_steps = _first_steps(experiment)
    used = first_steps < experiment.periods * experiment.steps_per_period
    used_inputs = [
        (name, (time[time < experiment.duration], values[time < experiment.duration]))
        for name, (time, values) in experiment.inputs.items()
    ]
    command_stamps = np.round(first_steps[used] * experiment.step_size * _NANOSECONDS).astype(np.int64)
    return Simulated(
        np.round(np.arange(experiment.periods + 1) * period).astype(np.int64),
        states,
        (command_stamps, experiment.voltages[used]),
        parameters,
        [(round(start * period), name, value) for start, name, value in changes],
        experiment.composition,
        {name: (np.round(time * _NANOSECONDS).astype(np.int64), values) for name, (time, values) in used_inputs},
    )


def _add_noise(states: FloatArray, experiment: Experiment) -> None:
    generator = np.random.default_rng(experiment.seed)
    for name, size in (
        ("measured_position", POSITION_NOISE),
        ("measured_velocity", VELOCITY_NOISE),
        ("measured_pressure_a", PRESSURE_NOISE),
        ("measured_pressure_b", PRESSURE_NOISE),
    ):
        states[:, COLUMNS.index(name)] += experiment.noise * size * generator.standard_normal(len(states))


Message = tuple[int, int, str, str, bytes]


def write_simulated(path: str | Path, record: Simulated, instruments_only: bool = False) -> int:
    """Write a simulated record with the simulator node's topics; return the number of messages.

    With `instruments_only` the file has only the channels of a rig's instruments and nothing of the model: no state,
    effort, leakage or parameters. The same record always gives the same bytes.

    Raises:
        RecordingError: the file exists already or cannot be written.
    """
    topics = list(_sensor_messages(record, instruments_only))
    if not instruments_only:
        topics += [_state_messages(record), _leakage_messages(record), _parameter_events(record)]
    parameters: dict[str, object] = {} if instruments_only else dict(record.parameters)
    if parameters and not record.composition.is_papers:
        parameters |= {f"plant.{kind}": name for kind, name in record.composition.names.items()}
    with RecordingWriter(path, parameters, flush_period=inf) as writer:
        for stamp, _, topic, type_name, data in merge(*topics):
            quality = _LATCHED if topic == "/internal_leakage" else None
            writer.write(topic, type_name, data, stamp, quality)
        return writer.message_count


def topic_messages(
    order: int,
    topic: str,
    type_name: str,
    stamps: NDArray[np.int64],
    columns: Mapping[str, FloatArray],
    has_header: bool = True,
    **fixed: Any,
) -> Iterator[Message]:
    """Messages of one topic, serialised block by block; `order` is the topic's place among those of one instant."""
    for start in range(0, len(stamps), _BLOCK):
        part = slice(start, start + _BLOCK)
        block = {name: numbers[part] for name, numbers in columns.items()}
        rows = encode_rows(type_name, block, stamps[part] if has_header else None, **fixed)
        for stamp, row in zip(stamps[part].tolist(), rows, strict=True):
            yield stamp, order, topic, type_name, row


def _sensor_messages(record: Simulated, instruments_only: bool) -> Iterator[Iterator[Message]]:
    atmosphere = record.atmosphere
    for order, chamber in enumerate("ab", start=2):
        pressure = {"fluid_pressure": record.column(f"measured_pressure_{chamber}") + atmosphere}
        yield topic_messages(order, f"/chamber_{chamber}/pressure", PRESSURE, record.stamps, pressure)
    motion = {"position": record.column("measured_position"), "velocity": record.column("measured_velocity")}
    if not instruments_only:
        motion["effort"] = record.column("hydraulic_force")
    yield topic_messages(5, "/joint_states", JOINTS, record.stamps, motion, name=["piston"])
    stamps, voltages = record.commands
    yield topic_messages(6, "/voltage_command", FLOAT, stamps, {"data": voltages}, has_header=False)


def _state_messages(record: Simulated) -> Iterator[Message]:
    return topic_messages(4, "/state", STATE, record.stamps, {name: record.column(name) for name in COLUMNS})


def _leakage_messages(record: Simulated) -> Iterator[Message]:
    leakage = record.column("internal_leakage")
    changed = np.flatnonzero(np.append(True, np.diff(leakage) != 0.0))
    stamps = record.stamps[changed]
    # A new value is in force, and published, at once: one period before a state shows it.
    set_at = [stamp for stamp, name, _ in record.changes if name == "internal_leakage"]
    before = record.stamps[np.maximum(changed - 1, 0)]
    stamps = np.where(np.isin(before, set_at), before, stamps)
    return topic_messages(1, "/internal_leakage", FLOAT, stamps, {"data": leakage[changed]}, has_header=False)


def _parameter_events(record: Simulated) -> Iterator[Message]:
    for stamp, name, value in record.changes:
        event = {
            "stamp": {"sec": stamp // _NANOSECONDS, "nanosec": stamp % _NANOSECONDS},
            "node": "/eha_sim",
            "changed_parameters": [{"name": name, "value": {"type": _DOUBLE, "double_value": value}}],
        }
        yield stamp, 0, "/parameter_events", PARAMETER_EVENT, encode(PARAMETER_EVENT, event)
