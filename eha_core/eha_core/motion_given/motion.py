"""Measured motion and force on one even time axis, with the speed and acceleration that the motion implies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from eha_core.errors import RecordingError
from eha_core.health.noise import estimate_noise
from eha_core.motion_given.averaging import averaging_window
from eha_core.recording import Channel, Recording

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]

DRIVERS = ("voltage_command", "current", "spool", "flow_a", "flow_b")
"""Channels that drive the plant: where one was recorded, the motion is an answer and not given."""

FEWEST = 200
"""Samples below which no law is looked for: ten blocks of twenty (assumed)."""

QUIET = 0.003
"""Share of the largest speed that a differentiated position's noise may have: little beside the speeds at which
friction laws differ (assumed)."""

PRESSURES = ("pressure_a", "pressure_b")

GAP = 5.0
"""Sampling intervals without a sample from which on what lies between is not used (assumed)."""

PEAKED = 0.5
"""Share of the speed's energy within a fifth of one frequency from which on the motion is periodic (assumed)."""


@dataclass(frozen=True)
class Motion:
    """One recording: (n,) values on an even time axis, SI; pressure gauge, None where there was none.

    `used` is False in gaps of the recording. `period` [s] of a periodic motion, else None. `noise` [N] of the force,
    which an average over samples leaves unknown: then None. `moving` [m/s] is the speed from which on a direction is
    certain. `averaged` [s] is the window of a moving average that the force went through, None where none shows, and
    `position_averaged` the position's. `schedule` is a further quantity, in a unit of its own, on which coefficients
    may depend, and `schedule_name` what it is called in the file.
    """

    name: str
    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    force: Array
    pressure: Array | None
    used: Flags
    period: float | None
    noise: float | None
    moving: float
    averaged: float | None = None
    position_averaged: float | None = None
    schedule: Array | None = None
    schedule_name: str = ""

    def at(self, rows: Indices) -> Motion:
        """The values at some of the instants; what needs an even axis, the step among it, is lost."""
        arrays = {
            name: getattr(self, name)[rows]
            for name in ("time", "position", "velocity", "acceleration", "force", "used")
        }
        pressure = None if self.pressure is None else self.pressure[rows]
        schedule = None if self.schedule is None else self.schedule[rows]
        return replace(self, **arrays, pressure=pressure, schedule=schedule)

    @property
    def step(self) -> float:
        """The sampling interval [s]."""
        return float(self.time[1] - self.time[0])


def is_motion_given(recording: Recording) -> bool:
    """Whether force and motion were recorded and nothing that drives the plant."""
    channels = recording.channels
    return "force" in channels and "position" in channels and not any(name in channels for name in DRIVERS)


def motion_of(recording: Recording, areas: tuple[float, float] | None = None) -> Motion:
    """The motion and the force of a recording.

    Args:
        recording: with position and force, or both pressures in the force's place.
        areas: of chambers A and B [m^2], by which the pressures are a force.

    Raises:
        RecordingError: no position or no force, too few samples, or nothing moves.
    """
    where, channels = str(recording.path), recording.channels
    pushed = "force" not in channels and areas is not None and all(name in channels for name in PRESSURES)
    missing = next((name for name in ("position", "force") if name not in channels), None)
    if missing == "position" or (missing == "force" and not pushed):
        raise RecordingError(
            f"{where}: no {missing} channel; a law of given motion needs position, and force or both pressures"
        )
    stamps = channels["pressure_a" if pushed else "force"].time
    if len(stamps) < FEWEST:
        raise RecordingError(f"{where}: {len(stamps)} samples of the force are too few; record {FEWEST} or more")
    step = float(np.median(np.diff(stamps)))
    time = np.arange(stamps[0], stamps[-1] + 0.5 * step, step)
    on_axis = {name: np.interp(time, channel.time, channel.values) for name, channel in channels.items()}
    position = on_axis["position"]
    if pushed and areas is not None:
        on_axis["force"] = areas[0] * on_axis["pressure_a"] - areas[1] * on_axis["pressure_b"]
    noise = estimate_noise(channels["position"].values)
    if np.std(position) < 2.0 * noise:
        raise RecordingError(f"{where}: nothing moves: position spans {np.ptp(position):.3g} m, noise {noise:.3g} m")
    velocity, quiet = _velocity(position, step, noise)
    if "velocity" in on_axis:
        velocity, quiet = on_axis["velocity"], estimate_noise(channels["velocity"].values)
    recorded = on_axis["force"] if pushed else channels["force"].values
    averaged = _seconds(averaging_window(recorded), step)
    return Motion(
        name=recording.path.stem,
        time=time,
        position=position,
        velocity=velocity,
        acceleration=_acceleration(velocity, step, quiet),
        force=on_axis["force"],
        pressure=_pressure(on_axis),
        used=_near_a_sample(time, stamps, GAP * step),
        period=_period(velocity, step),
        noise=estimate_noise(recorded) if averaged is None else None,
        moving=4.0 * quiet,
        averaged=averaged,
        position_averaged=_seconds(averaging_window(channels["position"].values), step),
        schedule=on_axis.get("schedule"),
        schedule_name=_called(channels["schedule"]) if "schedule" in channels else "",
    )


def _called(channel: Channel) -> str:
    """The column's or topic's name, with the unit that the topics file gives."""
    rule = channel.rule
    name = (rule.column or rule.topic if rule else None) or channel.name
    return f"{name} [{rule.unit}]" if rule and rule.unit else name


def _seconds(samples: int | None, step: float) -> float | None:
    return None if samples is None else samples * step


def noise_of(motions: Sequence[Motion]) -> float | None:
    """The RMS noise [N] of the force of all motions; None where the noise of one is not known."""
    levels = [motion.noise for motion in motions if motion.noise is not None]
    return float(np.sqrt(np.mean(np.square(levels)))) if len(levels) == len(motions) else None


def _pressure(on_axis: Mapping[str, Array]) -> Array | None:
    """What presses a seal: the pressure across the piston, or the one chamber's that was measured."""
    a, b = on_axis.get("pressure_a"), on_axis.get("pressure_b")
    return a - b if a is not None and b is not None else a if b is None else b


def _near_a_sample(time: Array, stamps: Array, reach: float) -> Flags:
    after = np.clip(np.searchsorted(stamps, time), 1, len(stamps) - 1)
    return np.asarray(stamps[after] - stamps[after - 1] <= reach)


def _odd(samples: float, count: int) -> int:
    """A window of that many samples, odd, of five at least, and a tenth of the recording at most."""
    return 2 * (int(np.clip(ceil(samples), 5, max(5, count // 10))) // 2) + 1


def _velocity(position: Array, step: float, noise: float) -> tuple[Array, float]:
    """The derivative of local parabolas, over no longer a window than its noise asks for, and that noise [m/s]."""
    fastest = float(np.quantile(np.abs(np.gradient(savgol_filter(position, 5, 2), step)), 0.98))
    window = _odd((12.0 * (noise / (QUIET * fastest * step)) ** 2) ** (1.0 / 3.0), len(position))
    found = savgol_filter(position, window, 2, deriv=1, delta=step)
    return found, noise / step * (12.0 / window**3) ** 0.5


def _acceleration(velocity: Array, step: float, noise: float) -> Array:
    largest = float(np.quantile(np.abs(np.gradient(savgol_filter(velocity, 5, 2), step)), 0.98))
    window = _odd((12.0 * (noise / (QUIET * largest * step)) ** 2) ** (1.0 / 3.0), len(velocity))
    return np.asarray(savgol_filter(velocity, window, 2, deriv=1, delta=step))


def _period(velocity: Array, step: float) -> float | None:
    """The period of a motion that has one, from where a parabola through the spectrum's largest values peaks."""
    spectrum = np.abs(np.fft.rfft((velocity - velocity.mean()) * np.hanning(len(velocity)))) ** 2
    top = int(np.argmax(spectrum))
    near = np.abs(np.arange(len(spectrum)) - top) <= max(2.0, 0.2 * top)
    if not 0 < top < len(spectrum) - 1 or spectrum[near].sum() < PEAKED * spectrum.sum():
        return None
    before, at, after = np.log(spectrum[top - 1 : top + 2] + 1e-300)
    exact = top + 0.5 * (before - after) / (before - 2.0 * at + after)
    return float(len(velocity) * step / exact)
