"""What was recorded and what was found of it, as frozen facts; the report writes the sentences."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Record:
    """One file as recorded.

    Attributes:
        source: the file's name.
        time: (n,) instants of the motion [s], rising.
        motion: (n,) position or velocity [motion_unit].
        motion_unit: its unit as the user's file has it, such as "mm", "deg" or "deg/s".
        is_velocity: whether the motion is a velocity.
        command_time: (m,) instants from which the commands hold [s].
        command: (m,) commands [command_unit].
        command_unit: "%", "V", "mA", "bar" ...
        has_own_times: whether a command's instant is known by itself, and not only to a sample of the motion.
        remarks: rows left out and the like.
    """

    source: str
    time: Array
    motion: Array
    motion_unit: str
    is_velocity: bool
    command_time: Array
    command: Array
    command_unit: str
    has_own_times: bool = False
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Estimate:
    """A figure and half of its 95 % interval, in one unit."""

    value: float
    reach: float

    @property
    def is_sure(self) -> bool:
        """Whether zero lies outside of the interval."""
        return abs(self.value) > self.reach

    @property
    def deviation(self) -> float:
        """The standard deviation that the interval stands for."""
        return self.reach / 1.96


@dataclass(frozen=True)
class Step:
    """One step of the command with its figures; None where one is open, `open` then says why.

    Attributes:
        source: the file's name.
        start: instant of the command's change [s since the file's first sample].
        duration: time until the command goes back, or the record ends [s].
        level: the command less neutral [command unit]; its sign is the direction.
        moved: whether the motion is more than the noise.
        delay: from the command's change to the beginning of the motion [s].
        rise: time constant of the rise of the speed [s].
        speed: steady speed beyond the drift before the step [motion unit per s].
        stopping: from the command's going back to the beginning of the slowing [s].
        stopped_after: time after the command's change at which the motion stopped while the command held [s].
        stopped_at: the position there [motion unit]; None of a velocity.
        noise: standard deviation of the motion at rest [motion unit].
        drift: speed before the step; of a velocity its offset [motion unit per s, or motion unit].
        places: position at rest before and after the step [motion unit]; of a velocity zeros.
        resolution: how well the instant of the command's change is known [s].
        unseen: of a step without motion, the speed below which a motion would not have been seen.
        open: by figure, why it is open and what to record; "level" where it is not clear whether it moved.
        drawn: instants [s since the change], the motion and the fitted law.
    """

    source: str
    start: float
    duration: float
    level: float
    moved: bool
    delay: Estimate | None
    rise: Estimate | None
    speed: Estimate | None
    stopping: Estimate | None
    stopped_after: float | None
    stopped_at: Estimate | None
    noise: float
    drift: Estimate
    places: tuple[float, float]
    resolution: float
    unseen: float | None = None
    open: dict[str, str] = field(default_factory=dict)
    drawn: tuple[Array, Array, Array] | None = None

    @property
    def sign(self) -> int:
        """1 of a positive, -1 of a negative command."""
        return 1 if self.level > 0.0 else -1


@dataclass(frozen=True)
class Direction:
    """All steps of one direction together; None where a figure is open, `open` then says why.

    Levels and the dead zone count from neutral without a sign; speeds and gain keep theirs.

    Attributes:
        sign: 1 of positive, -1 of negative commands.
        steps: number of steps.
        levels: number of different levels.
        still: largest level without motion; None where every step moved.
        unseen: the speed below which no motion would have been seen there.
        moving: smallest level with motion; None where none did.
        dead_zone: level at which the line of speed over level begins [command unit].
        gain: slope of that line [speed unit per command unit].
        saturation: speed that the largest levels no longer exceed; None where there is no sign of it.
        knee: level at which the line reaches that speed.
        delay: mean over the steps [s].
        delay_slope: its change with the level [s per command unit]; None where none is significant.
        end_stop: position at which several steps stopped [motion unit].
        open: by figure, why it is open and what to record.
        remarks: what else a reader must know.
    """

    sign: int
    steps: int
    levels: int
    still: float | None = None
    unseen: float | None = None
    moving: float | None = None
    dead_zone: Estimate | None = None
    gain: Estimate | None = None
    saturation: Estimate | None = None
    knee: Estimate | None = None
    delay: Estimate | None = None
    delay_slope: Estimate | None = None
    end_stop: Estimate | None = None
    open: dict[str, str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class StepTests:
    """All steps of one machine, and what they show together; units as in the first file."""

    steps: tuple[Step, ...]
    directions: tuple[Direction, ...]
    command_unit: str
    motion_unit: str
    is_velocity: bool
    remarks: tuple[str, ...] = ()

    @property
    def speed_unit(self) -> str:
        """The unit of speeds."""
        return self.motion_unit if self.is_velocity else f"{self.motion_unit}/s"
