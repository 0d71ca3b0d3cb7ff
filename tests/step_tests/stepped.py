"""Step tests in closed form, written apart from the library: dead time, first-order lag, constant speed, hard stop."""

from __future__ import annotations

import numpy as np
from scipy.integrate import cumulative_trapezoid

from eha_core.step_tests import Selection, StepTests, read_steps, records_of

DEAD_ZONE, GAIN = 18.0, 0.4
"""% and deg/s per %."""

LEVELS = (10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0)


def speed_of(level: float) -> float:
    """Steady speed [deg/s]."""
    return GAIN * max(level - DEAD_ZONE, 0.0)


def motion(
    time: np.ndarray, speed: float, *, on: float = 1.0, off: float = 3.0, delay: float = 0.08, lag: float = 0.05,
    stopping: float = 0.05, fall: float = 0.03, stop: float = np.inf,
) -> np.ndarray:  # fmt: skip
    """Position [deg], integrated from the speed on a grid of 0.1 ms."""
    fine = np.arange(0.0, time[-1] + 1e-3, 1e-4)
    rising = np.where(fine > on + delay, 1.0 - np.exp(-(fine - on - delay) / lag), 0.0)
    falling = np.where(fine > off + stopping, 1.0 - np.exp(-np.maximum(fine - off - stopping, 0.0) / fall), 0.0)
    place = cumulative_trapezoid(speed * (rising - falling), fine, initial=0.0)
    return np.interp(time, fine, np.minimum(place, stop))


def table(
    level: float, random: np.random.Generator, *, speed: float | None = None, noise: float = 0.1, start: float = 100.0,
    drift: float = 0.0, length: float = 4.0, step: float = 0.01, on: float = 1.0, off: float = 3.0, **law: float,
) -> dict[str, np.ndarray]:  # fmt: skip
    """One file's columns; the samples stand at a random phase to the command."""
    time = np.arange(0.0, length, step) + random.uniform(0.0, step)
    size = speed_of(abs(level)) * np.sign(level) if speed is None else speed
    place = start + drift * time + motion(time, size, on=on, off=off, **law)
    return {
        "time": time,
        "duty [%]": np.where((time >= on) & (time < off), level, 0.0),
        "boom angle [deg]": place + random.normal(0.0, noise, time.size),
    }


def read(files: list[dict[str, np.ndarray]], **chosen: object) -> StepTests:
    """What the library finds."""
    return read_steps(records_of(files, Selection(**chosen)))  # type: ignore[arg-type]
