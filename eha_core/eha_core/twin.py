"""A model that runs beside a rig on the same command, and says which of its equations the rig departs from.

In each window the model starts from the rig's measured state, so that it neither drifts away nor hides a departure.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import NDArray

from eha_core.health.noise import residual_noise
from eha_core.health.signal import SAME_SIZE, by_differences
from eha_core.plant import Plant, Trajectory
from eha_core.realtime import NANOSECONDS
from eha_core.weak_form.model_errors import CHANNELS, EQUATIONS, equation_residuals

Array = NDArray[np.float64]

DRIFT = "position"
"""Named where the position leaves the model though no equation alone departs beyond noise: a slow error adds up."""

FROZEN, STALE = "frozen", "stale"
"""What a channel is that stands still to the last digit though it has noise, and one that brings nothing any more."""

_STILL = 20  # samples of one value in a row that a channel with noise does not have
_LIVELY = 0.95  # share of a window's samples that differ from the one before where a channel has noise
_LEAD = 0.1  # s of command that coil and spool see before the first window
_REACH = 0.02  # s to either side of a window's start from which its state is estimated
_LATE = 0.1  # s that commands and samples may come after the position of their time
_DEAD = 0.5  # s after which a channel that brings nothing is done without
_GAP = 0.1  # s without position: what happened meanwhile is not known, and the model starts anew


@dataclass(frozen=True)
class Settings:
    """What a twin is told beside the plant's parameters.

    Attributes:
        window: time after which the model is put back to the measured state [s].
        threshold: how many times the noise an equation, or the position, may be off.
        position_noise, pressure_noise: least noise reckoned with [m], [Pa]; more is read off the data.
        command_timeout: time without a command after which the drive's voltage is zero [s]; 0: never.
        command_limit: largest voltage the drive takes [V].
    """

    window: float = 1.0
    threshold: float = 5.0
    position_noise: float = 10e-6
    pressure_noise: float = 1e4
    command_timeout: float = 0.5
    command_limit: float = 10.0


@dataclass(frozen=True)
class Comparison:
    """What one window showed.

    Attributes:
        start, end: the window's stamps [ns].
        errors: RMS of measured minus simulated of each channel there was [SI].
        ratios: for each equation that could be examined, and for DRIFT, the RMS of its residual over its noise.
        departs: what departs beyond the threshold, the most first, and from which stamp on, through all windows
            since [ns]. DRIFT is among them only where no equation is.
        unsound: the channels that are FROZEN or STALE, and since which stamp [ns]; nothing is compared with them.
    """

    start: int
    end: int
    errors: Mapping[str, float]
    ratios: Mapping[str, float]
    departs: Mapping[str, int]
    unsound: Mapping[str, tuple[str, int]] = field(default_factory=dict)


@dataclass
class _Samples:
    """One channel, ordered by stamp; a stamp that steps back begins it anew."""

    stamps: list[int] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    published: list[int] = field(default_factory=list)

    def add(self, stamp: int, value: float, published: int = 0) -> bool:
        """Append a sample; return whether time went back. A stamp that is there already is passed over."""
        went_back = bool(self.stamps) and stamp < self.stamps[-1]
        if went_back:
            self.forget(len(self.stamps))
        if not self.stamps or stamp > self.stamps[-1]:
            self.stamps.append(stamp)
            self.values.append(value)
            self.published.append(published)
        return went_back

    def forget(self, count: int) -> None:
        """Forget the `count` oldest samples."""
        del self.stamps[:count], self.values[:count], self.published[:count]

    @property
    def newest(self) -> float:
        """The last stamp [ns]; -inf before the first."""
        return self.stamps[-1] if self.stamps else -inf

    def near(self, stamp: int, reach: int) -> tuple[Array, Array]:
        """Times relative to `stamp` [s] and values within `reach` of it [ns]."""
        part = slice(bisect_left(self.stamps, stamp - reach), bisect_left(self.stamps, stamp + reach + 1))
        return (np.array(self.stamps[part]) - stamp) / NANOSECONDS, np.array(self.values[part])


class Twin:
    """Compares a rig with the model, window by window.

    Feed it with `command`, `position` and `pressure` as messages come, in any order among the channels, and ask
    `compare` now and then. A command is taken to act from the last position that was published before it, unless the
    rig tells by `applied` which voltage was in force.
    Raises ParameterError for parameters that make no plant.
    """

    def __init__(
        self, parameters: Mapping[str, float] | None = None, step_size: float = 1e-4, settings: Settings | None = None
    ) -> None:
        self._plant = Plant(parameters, step_size)
        self._plant.advance(0.0, 1)  # compiled before anybody waits for it
        self._settings = settings or Settings()
        self._step_ns = _ns(step_size)
        self._channels = {name: _Samples() for name in CHANNELS}
        self._commands = _Samples()
        self._applied = _Samples()
        self._since: dict[str, int] = {}
        self._ended: dict[str, int] = {}  # the last stamp of each channel when samples were forgotten [ns]
        self._lively: set[str] = set()  # channels that have noise: no sample is like the one before it
        self._start: int | None = None  # of the window to come [ns]; None before there are samples enough
        self._is_warm = False  # whether coil and spool have seen the command

    @property
    def parameters(self) -> Mapping[str, float]:
        """Every parameter of the model, by its full name."""
        return self._plant.parameters

    def set_parameters(self, changes: Mapping[str, float]) -> None:
        """Change the model from the next window on, or raise ParameterError."""
        self._plant.set_parameters(changes)

    def command(self, published: int, voltage: float) -> None:
        """Take a command [V] and when it was published [ns]; one that is no finite number is refused as by a drive."""
        if np.isfinite(voltage):
            self._commands.add(published, voltage)

    def applied(self, stamp: int, voltage: float) -> None:
        """Take the voltage [V] that was in force in the period which ended at a stamp [ns], where the rig tells it."""
        if np.isfinite(voltage):
            self._applied.add(stamp, voltage)

    def position(self, stamp: int, value: float, published: int) -> None:
        """Take a measured position [m], the stamp it belongs to and when it was published [ns]."""
        if np.isfinite(value) and self._channels["position"].add(stamp, value, published):
            self._restart()

    def pressure(self, chamber: str, stamp: int, value: float) -> None:
        """Take the measured pressure of chamber "a" or "b" [Pa above the return line's reference] and its stamp."""
        if np.isfinite(value):
            self._channels[f"pressure_{chamber}"].add(stamp, value)

    def compare(self) -> Comparison | None:
        """Simulate the next window if all of it has come, and say how it compares; None where there is none yet."""
        if self._start is None:
            self._start = self._begin()
        if self._start is None:
            return None
        start = self._start
        end = start + self._rows * self._every * self._step_ns
        if not self._has_come(end) or self._passes_a_gap(end):
            return None
        if not self._is_warm:
            self._plant.reset()
            self._plant.run(self._voltages(start - _ns(_LEAD), start))
            self._is_warm = True
        self._plant.place(*self._measured_state(start))
        result = self._compared(start, end, self._plant.run(self._voltages(start, end), self._every))
        self._start = end
        self._forget_before(end - _ns(_LEAD))
        return result

    def _restart(self) -> None:
        """Begin anew with the samples to come."""
        self._start = None
        self._is_warm = False

    def _begin(self) -> int | None:
        """Return where the first window starts, and choose how dense its rows are, once there are samples enough."""
        stamps = self._channels["position"].stamps
        if len(stamps) < 2 or stamps[-1] - stamps[0] < _ns(_LEAD):
            return None
        spacing = float(np.median(np.diff(stamps)))
        self._every = max(1, round(spacing / self._step_ns))
        self._rows = max(1, _ns(self._settings.window) // (self._every * self._step_ns))
        return stamps[bisect_left(stamps, stamps[0] + _ns(_LEAD))]

    def _has_come(self, end: int) -> bool:
        """Whether every channel that lives has brought all samples up to `end`, and commands must have come too."""
        newest = self._channels["position"].newest
        if newest < end + _ns(_LATE):
            return False
        living = [samples for samples in (*self._channels.values(), self._applied) if samples.stamps]
        return newest >= end + _ns(_DEAD) or all(samples.newest >= end for samples in living)

    def _passes_a_gap(self, end: int) -> bool:
        """Whether positions are missing up to `end`; if so, begin anew after the gap."""
        samples = self._channels["position"]
        count = bisect_left(samples.stamps, end) + 1
        gaps = np.flatnonzero(np.diff(samples.stamps[:count]) > _ns(_GAP))
        if len(gaps):
            samples.forget(int(gaps[-1]) + 1)
            self._restart()
        return len(gaps) > 0

    def _forget_before(self, stamp: int) -> None:
        """Forget what no later window needs; the latest command before it stays in force."""
        self._ended |= {
            name: samples.stamps[-1] for name, samples in self._channels.items() if samples.stamps
        }
        for samples in (*self._channels.values(), self._applied):
            samples.forget(bisect_left(samples.stamps, stamp))
        first = self._channels["position"].published[0]
        self._commands.forget(max(0, bisect_left(self._commands.stamps, first) - 1))

    def _voltages(self, start: int, end: int) -> Array:
        """The drive's voltage in each of the plant's steps from `start` to `end` [ns]."""
        times = np.arange(start, end, self._step_ns)
        told = self._applied
        if told.stamps and told.stamps[0] <= start and told.newest >= end:
            return np.array(told.values)[np.searchsorted(told.stamps, times, side="right")]
        if not self._commands.stamps:
            return np.zeros(len(times))
        position, settings = self._channels["position"], self._settings
        published, heard = np.array(self._commands.stamps), np.array(position.published)
        before = np.searchsorted(heard, published, side="right") - 1
        earlier = position.stamps[0] + np.minimum(published - heard[0], -1)
        acts = np.where(before >= 0, np.array(position.stamps)[before], earlier)
        latest = np.searchsorted(acts, times, side="right") - 1
        voltages = np.clip(self._commands.values, -settings.command_limit, settings.command_limit)[latest]
        timeout = _ns(settings.command_timeout) or inf
        return np.where((latest >= 0) & (times - acts[latest] < timeout), voltages, 0.0)

    def _measured_state(self, stamp: int) -> tuple[float, float, float, float]:
        """Position, velocity and pressures at a stamp, as a parabola through the samples about it has them.

        A pressure that is not measured goes on as simulated.
        """
        fits = {}
        for name, samples in self._channels.items():
            times, values = samples.near(stamp, _ns(_REACH))
            if len(times) > 4:
                fits[name] = np.polynomial.Polynomial.fit(times, values, 2)
            elif len(times) > 1:
                fits[name] = np.polynomial.Polynomial.fit(times, values, 1)
        state = self._plant.state
        if "position" not in fits:  # sparse samples: the line between the two about the stamp
            stamps = np.array(self._channels["position"].stamps)
            after = int(np.clip(np.searchsorted(stamps, stamp), 1, len(stamps) - 1))
            part = slice(after - 1, after + 1)
            times = (stamps[part] - stamp) / NANOSECONDS
            fits["position"] = np.polynomial.Polynomial.fit(times, self._channels["position"].values[part], 1)
        return (
            float(fits["position"](0.0)),
            float(fits["position"].deriv()(0.0)),
            float(fits["pressure_a"](0.0)) if "pressure_a" in fits else state.pressure_a,
            float(fits["pressure_b"](0.0)) if "pressure_b" in fits else state.pressure_b,
        )

    def _compared(self, start: int, end: int, model: Trajectory) -> Comparison:
        """Hold the measured channels against the simulated ones."""
        stamps = start + self._every * self._step_ns * np.arange(1, self._rows + 1)
        least = (self._settings.position_noise, self._settings.pressure_noise, self._settings.pressure_noise)
        errors, noises = {}, {}
        unsound = self._unsound(start, end)
        for (name, samples), floor in zip(self._channels.items(), least, strict=True):
            if name not in unsound and samples.stamps and samples.stamps[0] <= start and samples.stamps[-1] >= end:
                errors[name] = np.interp(stamps, samples.stamps, samples.values) - getattr(model, f"measured_{name}")
                noises[name] = max(floor, residual_noise(errors[name]))
        residuals = {DRIFT: errors[DRIFT] / noises[DRIFT]} if DRIFT in errors else {}
        if len(errors) == len(CHANNELS):
            period = self._every * self._plant.step_size
            residuals |= equation_residuals(errors, noises, model, self._plant.parameters, period)
        ratios = {name: _rms(residual) for name, residual in residuals.items()}
        self._note(residuals, ratios, stamps)
        departing = [name for name in EQUATIONS if name in self._since] or list(self._since)
        departing.sort(key=lambda name: -ratios[name])
        return Comparison(
            start,
            end,
            {name: _rms(error) for name, error in errors.items()},
            ratios,
            {name: self._since[name] for name in departing},
            unsound,
        )

    def _unsound(self, start: int, end: int) -> dict[str, tuple[str, int]]:
        """The channels that brought nothing up to the end of a window, or stood still to the last digit in it."""
        found: dict[str, tuple[str, int]] = {}
        for name, samples in self._channels.items():
            if samples.newest < end:
                last = samples.stamps[-1] if samples.stamps else self._ended.get(name)
                found |= {name: (STALE, last)} if last is not None else {}
                continue
            part = slice(bisect_left(samples.stamps, start), bisect_left(samples.stamps, end + 1))
            values = np.array(samples.values[part])
            frozen = self._frozen_since(name, values, samples.stamps[part])
            if frozen is not None:
                found[name] = (FROZEN, frozen)
            elif _has_noise(values):
                self._lively.add(name)
        return found

    def _frozen_since(self, name: str, values: Array, stamps: list[int]) -> int | None:
        """Since when a channel, whose noise changes it with every sample, has had one value [ns]."""
        changes = np.flatnonzero(np.diff(values)) + 1
        edges = np.concatenate([[0], changes, [len(values)]]).astype(np.int64)
        longest = int(np.argmax(np.diff(edges)))
        first, count = int(edges[longest]), int(np.diff(edges)[longest])
        if name not in self._lively or count < _STILL:
            return None
        return stamps[first]

    def _note(self, residuals: Mapping[str, Array], ratios: Mapping[str, float], stamps: NDArray[np.int64]) -> None:
        """Keep since when each equation departs, and forget those that no longer do."""
        threshold = self._settings.threshold
        for name, residual in residuals.items():
            if ratios[name] > threshold and name not in self._since:
                first = int(np.argmax(np.abs(residual) > threshold))
                self._since[name] = int(stamps[first + (len(stamps) - len(residual)) // 2])
        self._since = {name: since for name, since in self._since.items() if ratios.get(name, 0.0) > threshold}


def _has_noise(values: Array) -> bool:
    """Whether no sample is like the one before, and what is rough in them is noise and no motion."""
    if len(values) < 2 * _STILL or np.count_nonzero(np.diff(values)) < _LIVELY * (len(values) - 1):
        return False
    third, fifth = (by_differences(values, order) for order in (3, 5))
    return SAME_SIZE[0] < third / max(fifth, 1e-300) < SAME_SIZE[1]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _ns(seconds: float) -> int:
    return round(seconds * NANOSECONDS)
