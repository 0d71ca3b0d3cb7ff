"""Timers and rates."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock, ROSClock
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle, ROSInterruptException, TimerCancelledError
from rclpy.handle import Handle
from rclpy.time import Time


@dataclass
class TimerInfo:
    """When a call was due, and when it came."""

    expected_call_time: Time
    actual_call_time: Time
    clock_type: Any = None


class Timer:
    """Calls a function periodically on a clock; made by Node.create_timer."""

    def __init__(
        self,
        callback: Callable[..., Any] | None,
        callback_group: CallbackGroup | None,
        timer_period_ns: int,
        clock: Clock,
        *,
        context: Context | None = None,
        autostart: bool = True,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        if timer_period_ns < 0:
            raise ValueError("timer period must be non-negative")
        self._clock = clock
        self._period = int(timer_period_ns)
        self._last = clock._nanoseconds()
        self._next = self._last + self._period
        self._cancelled = not autostart
        self._lifetime = Handle(self, self._delete)
        self._context = context
        self._wake = wake
        self.callback_group = callback_group
        self.callback = callback

    @property
    def callback(self) -> Callable[..., Any] | None:
        """Return the function the timer calls."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any] | None) -> None:
        self._callback = value
        self._wants_info = False
        if value is not None:
            try:
                parameters = list(inspect.signature(value).parameters.values())
            except (TypeError, ValueError):
                return
            self._wants_info = any(p.annotation in (TimerInfo, "TimerInfo") for p in parameters)

    @property
    def clock(self) -> Clock:
        """Return the clock the timer follows."""
        return self._clock

    @property
    def timer_period_ns(self) -> int:
        """Return the period in nanoseconds."""
        return self._period

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        self._period = int(value)
        self._wake()

    def is_ready(self) -> bool:
        """Tell whether a call is due."""
        self._check()
        return not self._cancelled and self._clock._nanoseconds() >= self._next

    def is_canceled(self) -> bool:
        """Tell whether the timer is cancelled."""
        self._check()
        return self._cancelled

    def cancel(self) -> None:
        """Stop calling until reset."""
        self._check()
        self._cancelled = True

    def reset(self) -> None:
        """Start again: the next call is one period from now."""
        self._check()
        self._next = self._clock._nanoseconds() + self._period
        self._cancelled = False
        self._wake()

    def time_since_last_call(self) -> int:
        """Return nanoseconds since the last call, or since the start."""
        self._check()
        return self._clock._nanoseconds() - self._last

    def time_until_next_call(self) -> int | None:
        """Return nanoseconds until the next call, None for a cancelled timer."""
        self._check()
        return None if self._cancelled else self._next - self._clock._nanoseconds()

    def _check(self) -> None:
        if self._destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")

    def _remaining(self) -> int | None:
        """Return nanoseconds a wait may last for this timer: None when only something else can make it due."""
        if self._cancelled or self._destroyed:
            return None
        remaining = self._next - self._clock._nanoseconds()
        if remaining <= 0:
            return 0
        if self._clock._is_simulated():
            return None  # the next /clock message ends the wait
        return remaining

    def _take(self) -> TimerInfo | bool | None:
        if self._cancelled or self._destroyed:
            return None
        now = self._clock._nanoseconds()
        if now < self._next:
            if isinstance(self._clock, ROSClock) and now < self._last:
                self._next = now + self._period  # time jumped back
                self._last = now
            return None
        due, self._last = self._next, now
        self._next += self._period
        if self._next < now:  # missed calls are dropped, the phase is kept
            behind = (now - self._next) // self._period + 1 if self._period else 0
            self._next = self._next + behind * self._period if self._period else now
        if not self._wants_info:
            return True
        kind = self._clock.clock_type
        return TimerInfo(Time(nanoseconds=due, clock_type=kind), Time(nanoseconds=now, clock_type=kind), kind)

    def _handle(self, taken: TimerInfo | bool) -> Any:
        if self._callback is None:
            return None
        return self._callback(taken) if self._wants_info else self._callback()

    def call(self) -> None:
        """Note a call as rcl's does; the executor uses it before the callback.

        Raises:
            TimerCancelledError: the timer is cancelled.
        """
        self._check()
        if self._cancelled:
            raise TimerCancelledError("Timer was canceled")
        self._take()

    @property
    def handle(self) -> Handle:
        """Return the handle; `with timer.handle:` puts destruction off until the end of the block."""
        return self._lifetime

    @property
    def _destroyed(self) -> bool:
        return self._lifetime.destroyed

    def destroy(self) -> None:
        """End the timer."""
        self._lifetime.destroy_when_not_in_use()

    def _delete(self) -> None:
        if self._context is not None:
            self._context.changed()


class Rate:
    """Sleeps to the beat of a timer; made by Node.create_rate. Another thread must spin the node."""

    def __init__(self, timer: Timer, *, context: Context) -> None:
        self._clock = timer.clock
        self._timer = timer
        self._timer.callback = self._on_beat
        self._condition = threading.Condition()
        self._beats = 0
        self._is_shutdown = False
        self._is_destroyed = False
        context.on_shutdown(self._on_shutdown)

    def _on_beat(self) -> None:
        with self._condition:
            self._beats += 1
            self._condition.notify_all()

    def _on_shutdown(self) -> None:
        with self._condition:
            self._is_shutdown = True
            self._condition.notify_all()

    def destroy(self) -> None:
        """Wake every sleeper and end the rate."""
        with self._condition:
            self._is_destroyed = True
            self._condition.notify_all()

    def _presleep(self) -> None:
        if self._is_shutdown:
            raise ROSInterruptException()
        if self._is_destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
        if not self._timer._destroyed and self._timer.is_canceled():
            self._timer.reset()

    def sleep(self) -> None:
        """Sleep until the next beat.

        Raises:
            ROSInterruptException: rclpy was shut down. RuntimeError: the rate was destroyed.
        """
        self._presleep()
        with self._condition:
            beats = self._beats
            self._condition.wait_for(lambda: self._beats != beats or self._is_shutdown or self._is_destroyed)
        if self._is_shutdown:
            raise ROSInterruptException()
        if self._is_destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
