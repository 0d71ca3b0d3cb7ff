"""Stage 1, read and align: a recording's channels on one clock, with the noise level of each, ready for a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil, floor

import numpy as np

from eha_core.errors import RecordingError
from eha_core.health import Fault, Health, examine, in_words
from eha_core.health.noise import estimate_noise, find_outliers
from eha_core.identification.numbers import Array
from eha_core.nominal import NominalModel
from eha_core.plant import PAPER, Composition
from eha_core.plant.parts import Source
from eha_core.recording import CHANNEL_KINDS, Channel, Recording

TICK = 0.01
"""s; grid of the windows' begins and ends, a multiple of every step size used here."""

SHORTEST = 1.0
"""s; a shorter recording hardly identifies any parameter."""

FITTED = ("position", "velocity", "pressure_a", "pressure_b")
"""Channels that a simulation is compared with, in the order of the plant's measured columns."""

WITH_OIL = ("voltage", "measured")
"""Drives under which the oil in the chambers is simulated."""

NOT_COMPARED = dict.fromkeys(CHANNEL_KINDS, "recorded, but compared with nothing") | {
    "velocity": "checked for sign and scale against the position alone, as it may have been computed from it",
    "force": "recorded, but the pressures determine it",
}
"""Why a recorded channel is neither an input nor compared, by its name."""

RESOLVED = {"m": 1e-6, "m/s": 1e-3, "Pa": 3e3}
"""Smallest noise levels: below any sensor's, but above the error of the search's simulation, for noise-free
recordings."""

OVERSHOOT = 1.05
"""Share of the nominal stroke beyond which a measured position shows that the stroke is larger than stated."""


@dataclass(frozen=True)
class Measured:
    """One channel to be fitted: `values` (n,) at `time` (n,) [s], with the standard deviation of its noise."""

    name: str
    column: int
    time: Array
    values: Array
    noise: float


@dataclass(frozen=True)
class Observation:
    """A recording's inputs and outputs for a fit.

    Attributes:
        path: where it was read from.
        drive: the simulation's input: "voltage", "pressures", "force", or "measured": the channels of the composition's
        source.
        inputs: the driving channels, as (time, values); voltage is held between samples.
        measured: the channels that are compared.
        leakage: (time [s], change of the internal leakage coefficient since the start [m^3/(s Pa)]) of each change that
        the recording contains: a change on purpose is no mismatch.
        duration: [s].
        not_examined: equations that could not be examined, and why, one line each.
        remarks: corrections and exclusions, one line each.
        driving: names of the driving channels.
        composition: the actuator's parts.
        health: the faults of the recording's channels; samples with a fault are not among `measured`.
        undriven: intervals [s] in which the plant's input is not known, or its effect has not decayed yet.
    """

    path: str
    drive: str
    inputs: tuple[tuple[Array, Array], ...]
    measured: tuple[Measured, ...]
    leakage: tuple[tuple[float, float], ...]
    duration: float
    channels: tuple[str, ...]
    not_examined: tuple[str, ...]
    remarks: tuple[str, ...]
    driving: tuple[str, ...] = ("voltage_command",)
    composition: Composition = PAPER
    health: tuple[Fault, ...] = ()
    undriven: tuple[tuple[float, float], ...] = ()

    def channel(self, name: str) -> Measured | None:
        """The measured channel of that name, if there is one."""
        return next((channel for channel in self.measured if channel.name == name), None)


def observe(recording: Recording, composition: Composition = PAPER, health: Health | None = None) -> Observation:
    """Choose the simulation's inputs and the channels that it is compared with; estimate noise; exclude faults: those
    of its `health`, by default as `examine` finds it.

    A source that no voltage drives declares its own inputs.

    Raises RecordingError where no equation can be examined: too short, no position, no input, or constant.
    """
    channels = recording.channels
    where = str(recording.path)
    _require_position(recording)
    drive, driving, not_examined = _choose_drive(where, channels, composition.source)
    health = health or examine(recording)
    inputs = tuple(health.sound(channels[name]) for name in driving)
    undriven = _undriven(health, driving, recording.duration)
    remarks: list[str] = list(recording.remarks)
    measured = []
    for column, name in enumerate(FITTED):
        if name not in channels or (drive not in WITH_OIL and name.startswith("pressure")):
            continue
        # a velocity computed from the position adds nothing and its noise is not independent
        if name == "velocity":
            continue
        measured.append(_measured(where, channels[name], column, health, undriven, remarks))
    used = {*driving, *(channel.name for channel in measured)}
    not_examined += [f"{name}: {NOT_COMPARED[name]}" for name in channels if name not in used]
    _require_motion(where, measured[0])
    for name in ("pressure_a", "pressure_b"):
        if name not in channels and drive in WITH_OIL:
            not_examined.append(f"continuity of chamber {name[-1]}: {name} was not recorded")
    leakage = _leakage(recording) if drive in WITH_OIL else ()
    if leakage:
        remarks.append(f"internal leakage was changed on purpose {len(leakage)} times; the simulation follows")
    return Observation(
        where,
        drive,
        inputs,
        tuple(measured),
        leakage,
        recording.duration,
        tuple(channels),
        tuple(not_examined),
        tuple(remarks),
        driving,
        composition,
        health.faults,
        undriven,
    )


def _require_position(recording: Recording) -> None:
    """Raise RecordingError where a recording is too short, or has no position."""
    where = recording.path
    if recording.duration < SHORTEST:
        raise RecordingError(
            f"{where}: {recording.duration:.3g} s of data are too short to diagnose; record {SHORTEST:g} s or more"
        )
    if "position" not in recording.channels:
        raise RecordingError(
            f"{where}: no position channel among {', '.join(recording.channels) or 'none'}; map one to `position`"
            " in a topics file"
        )


def _require_motion(where: str, position: Measured) -> None:
    """Raise RecordingError where the piston does not move."""
    if np.ptp(position.values) < 4.0 * position.noise:
        raise RecordingError(
            f"{where}: the position does not move (it spans {np.ptp(position.values):.3g} m, its noise is "
            f"{position.noise:.3g} m); record a test that moves the piston"
        )


def _leakage(recording: Recording) -> tuple[tuple[float, float], ...]:
    """The changes after the start, relative to the coefficient at the start."""
    changes = recording.leakage_changes
    if not changes:
        return ()
    first = next((value for time, value in reversed(changes) if time <= 0.0), changes[0][1])
    return tuple((time, value - first) for time, value in changes if 0.0 < time < recording.duration and value != first)


def with_sufficient_stroke(observation: Observation, model: NominalModel) -> tuple[Observation, NominalModel]:
    """The nominal model with a stroke that covers the measured positions, and a remark where it had to be enlarged."""
    position = observation.channel("position")
    assert position is not None
    farthest = float(np.max(np.abs(position.values)))
    stroke = model.values["actuator_displacement"]
    if farthest <= OVERSHOOT * stroke:
        return observation, model
    remark = (
        f"position reaches {farthest:.3g} m, beyond the nominal actuator_displacement of {stroke:.3g} m: taken as"
        f" {OVERSHOOT * farthest:.3g} m; give the rig's own, and position from mid-stroke"
    )
    enlarged = {**model.values, "actuator_displacement": OVERSHOOT * farthest}
    return replace(observation, remarks=(*observation.remarks, remark)), replace(model, values=enlarged)


def without_end(observation: Observation, moment: float, why: str) -> Observation:
    """The recording without its last `moment` [s], and a remark with the reason."""
    duration = observation.duration - moment
    remark = f"the last {moment:g} s were excluded: {why}"
    return replace(
        observation,
        inputs=tuple((time[time < duration], values[time < duration]) for time, values in observation.inputs),
        measured=tuple(
            replace(channel, time=channel.time[channel.time < duration], values=channel.values[channel.time < duration])
            for channel in observation.measured
        ),
        leakage=tuple(change for change in observation.leakage if change[0] < duration),
        duration=duration,
        remarks=(*observation.remarks, remark),
    )


def _choose_drive(
    where: str, channels: Mapping[str, Channel], source: Source
) -> tuple[str, tuple[str, ...], list[str]]:
    """The best available drive, its channels, and the equations that cannot be examined with it."""
    if source.valve != "coil":
        return _given_by(where, channels, source)
    if "voltage_command" in channels:
        command = channels["voltage_command"]
        if np.ptp(command.values) == 0.0:
            raise RecordingError(
                f"{where}: the voltage command is constant at {command.values[0]:.3g} V; record a test that"
                " excites the rig"
            )
        return "voltage", ("voltage_command",), []
    unexamined = ["coil, spool and valve flow: no voltage_command was recorded"]
    if "force" in channels:
        return "force", ("force",), [*unexamined, "continuity of both chambers: force alone was recorded"]
    if "pressure_a" in channels and "pressure_b" in channels:
        unexamined.append("continuity of both chambers: their flows are not known")
        return "pressures", ("pressure_a", "pressure_b"), unexamined
    raise RecordingError(
        f"{where}: nothing there drives the piston; record voltage_command, or force, or both chamber pressures"
    )


def _given_by(where: str, channels: Mapping[str, Channel], source: Source) -> tuple[str, tuple[str, ...], list[str]]:
    """The drive, its channels and the unexamined equations of a source that no voltage drives."""
    missing = next((name for name in source.inputs if name not in channels), None)
    if missing is not None:
        raise RecordingError(
            f"{where}: no {missing} was recorded, and plant.source = {source.id} is driven by"
            f" {' and '.join(source.inputs)}; map it in a topics file, or name another source"
        )
    driving = (*source.inputs, *(name for name in source.optional if name in channels))
    return source.given or "measured", driving, [f"what brings about {' and '.join(driving)}: it was taken as measured"]


def _undriven(health: Health, driving: tuple[str, ...], duration: float) -> tuple[tuple[float, float], ...]:
    """The intervals in which the plant's input is not known, on the grid of the windows."""
    spans = health.unknown_of(driving, duration)
    return tuple((TICK * floor(begin / TICK), min(TICK * ceil(end / TICK), duration)) for begin, end in spans)


def _measured(
    where: str,
    channel: Channel,
    column: int,
    health: Health,
    undriven: tuple[tuple[float, float], ...],
    remarks: list[str],
) -> Measured:
    time, values = health.sound(channel)
    known = np.ones(len(time), dtype=np.bool_)
    for begin, end in undriven:
        known &= (time < begin) | (time > end)
    if np.count_nonzero(known) * float(np.median(np.diff(channel.time))) < SHORTEST / 2.0:
        raise RecordingError(
            f"{where}: almost nothing of {channel.name} can be used ({'; '.join(in_words(health.faults))}); record the"
            " test again"
        )
    noise = max(estimate_noise(values), RESOLVED[channel.unit])
    bad = find_outliers(values, noise)
    if bad.any():
        excluded = "1 outlier was excluded" if bad.sum() == 1 else f"{bad.sum()} outliers were excluded"
        remarks.append(f"{channel.name}: {excluded}")
    known &= ~bad
    return Measured(channel.name, column, time[known], values[known], noise)
