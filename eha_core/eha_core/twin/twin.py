"""A rig compared with its model, window by window."""

from __future__ import annotations

from bisect import bisect_left
from collections import deque
from collections.abc import Mapping, Sequence
from math import inf

import numpy as np
from numpy.typing import NDArray

from eha_core.health.noise import residual_noise
from eha_core.plant import Plant, Trajectory
from eha_core.realtime import NANOSECONDS
from eha_core.twin.comparison import DRIFT, Comparison, Settings
from eha_core.twin.e_detector import Detector, log_e_value
from eha_core.twin.excerpt import Excerpt, held_changes
from eha_core.twin.measured_state import State, corrected_state, measured_state
from eha_core.twin.samples import Array, Samples, nanoseconds
from eha_core.twin.soundness import Soundness
from eha_core.weak_form.model_errors import CHANNELS, EQUATIONS, equation_residuals
from eha_core.weak_form.weighting import weighting

_LEAD = 0.1  # s in which coil and spool settle, and then the chambers, before the first window
_REACH = 0.02  # s to either side of a window's start from which its state is estimated, two samples at least
_LATE = 0.1  # s that commands and samples may come after the position of their time
_DEAD = 0.5  # s after which a channel that brings nothing is done without
_SEEN_AT_ONCE = 3.0  # times what is allowed, beyond which a sample shows by itself when a departure began
_GAP = 0.1  # s without position: what happened meanwhile is not known, and the model starts anew


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
        self._step_ns = nanoseconds(step_size)
        self._channels = {name: Samples() for name in CHANNELS}
        self._commands = Samples()
        self._applied = Samples()
        windows = 3600.0 * self._settings.false_alarm_hours / self._settings.window
        names = (DRIFT, *EQUATIONS)
        self._detectors = {name: Detector(len(names) * windows) for name in names}
        self._since: dict[str, int] = {}
        self._soundness = Soundness()
        self._kept: deque[Excerpt] = deque()
        self._start: int | None = None  # of the window to come [ns]; None before there are samples enough
        self._before: Trajectory | None = None  # what was simulated up to there

    @property
    def kept(self) -> Sequence[Excerpt]:
        """The windows compared last, each beginning where the one before ended, the newest at the end."""
        return self._kept

    @property
    def evidence(self) -> tuple[float, float]:
        """The most evidence of a departure that any equation has, and what an alarm needs [natural logarithms]."""
        detectors = self._detectors.values()
        return max(each.evidence for each in detectors), min(each.needed for each in detectors)

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
        end = start + self._rows * self._row_time
        if not self._has_come(end) or self._passes_a_gap(end):
            return None
        if self._before is None:
            self._before = self._led_to(start)
        self._plant.place(*self._corrected(start, self._before))
        voltages = self._voltages(start, end)
        self._before = self._plant.run(voltages, self._every)
        self._keep(start, end, voltages)
        self._start = end
        result = self._compared(start, end, self._before)
        self._forget_before(end - self._reach)
        return result

    def _led_to(self, start: int) -> Trajectory:
        """Simulate what is before the first window, from a rough state: coil and spool alone, then the whole plant."""
        lead = self._lead
        self._plant.reset()
        self._plant.run(self._voltages(start - 2 * lead, start - lead))
        self._plant.place(*measured_state(self._channels, start - lead, self._reach, self._plant.state))
        return self._plant.run(self._voltages(start - lead, start), self._every)

    def _corrected(self, start: int, before: Trajectory) -> State:
        """The rig's state at a window's start, to which the simulation has come; it looks ahead and goes back."""
        moment, state = self._plant.moment(), self._plant.state
        after = self._plant.run(self._voltages(start, start + self._reach), self._every)
        self._plant.return_to(moment)
        times = self._row_time * np.arange(1 - len(before.time), len(after.time) + 1) / NANOSECONDS
        measured = {name: f"measured_{name}" for name in CHANNELS}
        shown = {name: np.append(getattr(before, column), getattr(after, column)) for name, column in measured.items()}
        return corrected_state(self._channels, start, self._reach, state, times, shown)

    def _keep(self, start: int, end: int, voltages: Array) -> None:
        """Keep a window that was compared, and forget what is older than is asked for or lies before a gap."""
        kept = self._kept
        if kept and kept[-1].end != start:
            kept.clear()
        channels = {name: samples.between(start, end) for name, samples in self._channels.items() if samples.stamps}
        kept.append(Excerpt(start, end, held_changes(np.arange(start, end, self._step_ns), voltages), channels))
        while kept[0].end <= end - nanoseconds(self._settings.kept):
            kept.popleft()

    def _restart(self) -> None:
        """Begin anew with the samples to come."""
        self._start = None
        self._before = None

    def _begin(self) -> int | None:
        """Return where the first window starts, and choose how dense its rows are, once there are samples enough."""
        stamps = self._channels["position"].stamps
        if len(stamps) < 2:
            return None
        spacing = float(np.median(np.diff(stamps)))
        self._every = max(1, round(spacing / self._step_ns))
        self._row_time = self._every * self._step_ns
        self._rows = max(1, nanoseconds(self._settings.window) // self._row_time)
        self._reach = self._row_time * max(2, -(-nanoseconds(_REACH) // self._row_time))
        self._lead = self._row_time * max(2, -(-nanoseconds(_LEAD) // self._row_time))
        if stamps[-1] < stamps[0] + 2 * self._lead:
            return None
        return stamps[bisect_left(stamps, stamps[0] + 2 * self._lead)]

    def _has_come(self, end: int) -> bool:
        """Whether every channel that lives has brought all samples up to `end`, and commands must have come too."""
        newest = self._channels["position"].newest
        if newest < end + max(nanoseconds(_LATE), self._reach):
            return False
        living = [samples for samples in (*self._channels.values(), self._applied) if samples.stamps]
        return newest >= end + nanoseconds(_DEAD) or all(samples.newest >= end for samples in living)

    def _passes_a_gap(self, end: int) -> bool:
        """Whether positions are missing up to `end`; if so, begin anew after the gap."""
        samples = self._channels["position"]
        count = bisect_left(samples.stamps, end) + 1
        gaps = np.flatnonzero(np.diff(samples.stamps[:count]) > nanoseconds(_GAP))
        if len(gaps):
            samples.forget(int(gaps[-1]) + 1)
            self._restart()
        return len(gaps) > 0

    def _forget_before(self, stamp: int) -> None:
        """Forget what no later window needs; the latest command before it stays in force."""
        self._soundness.note_ends(self._channels)
        for samples in (*self._channels.values(), self._applied):
            samples.forget(bisect_left(samples.stamps, stamp))
        first = self._channels["position"].published[0]
        self._commands.forget(max(0, bisect_left(self._commands.stamps, first) - 1))

    def _voltages(self, start: int, end: int) -> Array:
        """The drive's voltage in each of the plant's steps from `start` to `end` [ns]."""
        times = np.arange(start, end, self._step_ns)
        applied = self._applied
        if applied.stamps and applied.stamps[0] <= start and applied.newest >= end:
            return np.array(applied.values)[np.searchsorted(applied.stamps, times, side="right")]
        if not self._commands.stamps:
            return np.zeros(len(times))
        position, settings = self._channels["position"], self._settings
        published, heard = np.array(self._commands.stamps), np.array(position.published)
        before = np.searchsorted(heard, published, side="right") - 1
        earlier = position.stamps[0] + np.minimum(published - heard[0], -1)
        acts = np.where(before >= 0, np.array(position.stamps)[before], earlier)
        latest = np.searchsorted(acts, times, side="right") - 1
        voltages = np.clip(self._commands.values, -settings.command_limit, settings.command_limit)[latest]
        timeout = nanoseconds(settings.command_timeout) or inf
        return np.where((latest >= 0) & (times - acts[latest] < timeout), voltages, 0.0)

    def _compared(self, start: int, end: int, model: Trajectory) -> Comparison:
        """Hold the measured channels against the simulated ones."""
        stamps = start + self._row_time * np.arange(1, self._rows + 1)
        least = (self._settings.position_noise, self._settings.pressure_noise, self._settings.pressure_noise)
        errors, noises = {}, {}
        unsound = self._soundness.unsound(self._channels, start, end)
        for (name, samples), floor in zip(self._channels.items(), least, strict=True):
            if name not in unsound and samples.stamps and samples.stamps[0] <= start and samples.stamps[-1] >= end:
                errors[name] = np.interp(stamps, samples.stamps, samples.values) - getattr(model, f"measured_{name}")
                noises[name] = max(floor, residual_noise(errors[name]))
        residuals = {DRIFT: errors[DRIFT] / noises[DRIFT]} if DRIFT in errors else {}
        if len(errors) == len(CHANNELS):
            period = self._every * self._plant.step_size
            residuals |= equation_residuals(errors, noises, model, self._plant.parameters, period)
        ratios = {name: _rms(residual) for name, residual in residuals.items() if np.any(np.isfinite(residual))}
        self._note(residuals, stamps)
        alarmed = [name for name, detector in self._detectors.items() if detector.is_alarmed and name in ratios]
        departing = [name for name in alarmed if name in EQUATIONS]
        if not any(name in ratios and self._detectors[name].is_suspicious for name in EQUATIONS):
            departing = alarmed  # else the next window tells which equation the position's error comes from
        departing.sort(key=lambda name: -ratios[name])
        return Comparison(
            start,
            end,
            {name: _rms(error) for name, error in errors.items()},
            noises,
            ratios,
            {name: self._since[name] for name in departing},
            unsound,
        )

    def _note(self, residuals: Mapping[str, Array], stamps: NDArray[np.int64]) -> None:
        """Weigh what each equation leaves, and keep since when one is suspicious."""
        allowed = self._settings.threshold
        apart = len(weighting(self._every * self._plant.step_size).weight)  # so that noise is independent
        for name, residual in residuals.items():
            detector = self._detectors[name]
            independent = residual[::apart]
            independent = independent[np.isfinite(independent)]
            if not len(independent):
                continue  # a window that shows nothing is no evidence, and none of the time between two alarms
            detector.weigh(float(log_e_value(independent, allowed)))
            if not detector.is_suspicious:
                self._since.pop(name, None)
            elif name not in self._since:
                large = np.abs(residual) > _SEEN_AT_ONCE * allowed
                self._since[name] = int(stamps[int(np.argmax(large)) + (len(stamps) - len(residual)) // 2])


def _rms(values: Array) -> float:
    return float(np.sqrt(np.nanmean(values**2)))
