"""Clocks: system, steady and the ROS clock that can follow /clock."""

from __future__ import annotations

import threading
import time as _time
from collections.abc import Callable
from enum import IntEnum
from types import TracebackType
from typing import Any

from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.exceptions import NotInitializedException
from rclpy.time import Time

__all__ = ["Clock", "ClockChange", "ClockType", "JumpHandle", "JumpThreshold", "ROSClock", "TimeJump"]


class ClockChange(IntEnum):
    """What happened to a ROS clock's source."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


class JumpThreshold:
    """How large a jump of time must be for callbacks to run."""

    def __init__(
        self, *, min_forward: Duration | None, min_backward: Duration | None, on_clock_change: bool = True
    ) -> None:
        if min_forward is not None and min_forward.nanoseconds <= 0:
            raise ValueError("min_forward must be a positive non-zero duration")
        if min_backward is not None and min_backward.nanoseconds >= 0:
            raise ValueError("min_backward must be a negative non-zero duration")
        if min_forward is None and min_backward is None and not on_clock_change:
            raise ValueError("At least one jump threshold must be enabled")
        self.min_forward = min_forward
        self.min_backward = min_backward
        self.on_clock_change = on_clock_change

    def exceeded(self, change: ClockChange, delta: int) -> bool:
        """Tell whether a change of source or a jump by `delta` nanoseconds passes the threshold."""
        if change in (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED):
            return self.on_clock_change
        if self.min_forward is not None and delta >= self.min_forward.nanoseconds:
            return True
        return self.min_backward is not None and delta <= self.min_backward.nanoseconds


class TimeJump:
    """A jump of time: what changed, and by how much."""

    def __init__(self, clock_change: ClockChange, delta: Duration) -> None:
        if not isinstance(clock_change, ClockChange):
            raise TypeError("clock_change must be an instance of rclpy.clock.ClockChange")
        self._clock_change = clock_change
        self._delta = delta

    @property
    def clock_change(self) -> ClockChange:
        """Return what happened to the clock's source."""
        return self._clock_change

    @property
    def delta(self) -> Duration:
        """Return the new time minus the old one."""
        return self._delta


class JumpHandle:
    """A registration for jumps; also a context manager."""

    def __init__(
        self,
        *,
        clock: Clock,
        threshold: JumpThreshold,
        pre_callback: Callable[[], Any] | None,
        post_callback: Callable[[TimeJump], Any] | None,
    ) -> None:
        if pre_callback is None and post_callback is None:
            raise ValueError("One of pre_callback or post_callback must be callable")
        if pre_callback is not None and not callable(pre_callback):
            raise ValueError("pre_callback must be callable if given")
        if post_callback is not None and not callable(post_callback):
            raise ValueError("post_callback must be callable if given")
        self.threshold = threshold
        self.pre_callback = pre_callback
        self.post_callback = post_callback
        self._clock: Clock | None = clock
        clock._jump_handles.append(self)

    def unregister(self) -> None:
        """Remove the callbacks from the clock."""
        if self._clock is not None:
            self._clock._jump_handles.remove(self)
            self._clock = None

    def __enter__(self) -> JumpHandle:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.unregister()


class Clock:
    """A source of time. Clock(clock_type=ClockType.ROS_TIME) makes a ROSClock."""

    _clock_type: ClockType
    _jump_handles: list[JumpHandle]

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Clock:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        self = super().__new__(ROSClock if clock_type is ClockType.ROS_TIME else cls)
        self._clock_type = clock_type
        self._jump_handles = []
        return self

    @property
    def clock_type(self) -> ClockType:
        """Return which clock this is."""
        return self._clock_type

    def __repr__(self) -> str:
        return f"Clock(clock_type={self._clock_type.name})"

    def _nanoseconds(self) -> int:
        return _time.monotonic_ns() if self._clock_type is ClockType.STEADY_TIME else _time.time_ns()

    def now(self) -> Time:
        """Return the time on this clock."""
        return Time(nanoseconds=self._nanoseconds(), clock_type=self._clock_type)

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: Callable[[], Any] | None = None,
        post_callback: Callable[[TimeJump], Any] | None = None,
    ) -> JumpHandle:
        """Have callbacks run before and after a jump of time that passes the threshold."""
        return JumpHandle(clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=post_callback)

    def sleep_until(self, until: Time, context: Context | None = None) -> bool:
        """Sleep until a time on this clock.

        Returns:
            True when the time was reached; False when the context was shut down or the clock's source changed.

        Raises:
            NotInitializedException: the context is not initialised.
            ValueError: the time is of another clock.
        """
        from rclpy.utilities import get_default_context

        context = context or get_default_context()
        if not context.ok():
            raise NotInitializedException()
        if until.clock_type != self._clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        event, source_changed = threading.Event(), False

        def on_jump(jump: TimeJump) -> None:
            nonlocal source_changed
            changes = (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED)
            source_changed = source_changed or jump.clock_change in changes
            if source_changed or self.now() >= until:
                event.set()

        context.on_shutdown(event.set)
        threshold = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=None, on_clock_change=True)
        try:
            with self.create_jump_callback(threshold, post_callback=on_jump):
                while not event.is_set() and (remaining := until.nanoseconds - self._nanoseconds()) > 0:
                    event.wait(None if self._is_simulated() else min(remaining / 1e9, threading.TIMEOUT_MAX))
        finally:
            context._forget_on_shutdown(event.set)
        if not context.ok() or source_changed:
            return False
        return self.now() >= until

    def _is_simulated(self) -> bool:
        return False

    def sleep_for(self, rel_time: Duration, context: Context | None = None) -> bool:
        """Sleep for a length of time on this clock; returns as sleep_until does."""
        return self.sleep_until(self.now() + rel_time, context)


class ROSClock(Clock):
    """The clock that shows system time, or what /clock says once simulated time is active."""

    def __new__(cls) -> ROSClock:
        self = super().__new__(Clock, clock_type=ClockType.ROS_TIME)
        assert isinstance(self, ROSClock)
        self._active = False
        self._override = 0
        return self

    _active: bool = False
    _override: int = 0

    def _nanoseconds(self) -> int:
        return self._override if self._active else _time.time_ns()

    def _is_simulated(self) -> bool:
        return self._active

    @property
    def ros_time_is_active(self) -> bool:
        """Tell whether the clock shows simulated time."""
        return self._active

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        if enabled == self._active:
            return
        change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
        before = self._nanoseconds()
        after = self._override if enabled else _time.time_ns()

        def switch() -> None:
            self._active = enabled

        self._jump(change, after - before, switch)

    def set_ros_time_override(self, time: Time) -> None:
        """Set the simulated time."""
        if not isinstance(time, Time):
            raise TypeError(f"Time must be specified as rclpy.time.Time. Received type: {type(time)}")
        value = time.nanoseconds
        if not self._active or not self._jump_handles:
            self._override = value
            return

        def move() -> None:
            self._override = value

        self._jump(ClockChange.ROS_TIME_NO_CHANGE, value - self._override, move)

    def _jump(self, change: ClockChange, delta: int, apply: Callable[[], None]) -> None:
        handles = [handle for handle in self._jump_handles if handle.threshold.exceeded(change, delta)]
        for handle in handles:
            if handle.pre_callback is not None:
                handle.pre_callback()
        apply()
        for handle in handles:
            if handle.post_callback is not None:
                handle.post_callback(TimeJump(change, Duration(nanoseconds=delta)))
