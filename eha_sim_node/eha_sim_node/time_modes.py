"""Who drives the simulator's time: the wall clock, at its pace or another, or the commands."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from rclpy.clock import Clock, ClockType

from eha_core.errors import EhaError
from eha_core.realtime import FIRST_ANSWER, LONG_WAIT, NANOSECONDS, LockstepGate, Pacer
from eha_sim_node.parameters import Value

if TYPE_CHECKING:
    from eha_sim_node.sim import SimNode

_LARGEST_CLOCK_STEP = NANOSECONDS // 10
_PEER_CHECK = 0.05  # s
_MOST_STEPS = 10_000_000  # steps taken at one request: a second or two, in which the node answers nobody


class StepRefused(EhaError):
    """The simulator cannot step now."""


class TimeMode(Protocol):
    """What the simulator node asks of a time mode."""

    def stamp(self) -> int:
        """Return the time that the plant's state belongs to, as headers carry it [ns]."""

    def command_arrived(self) -> None:
        """Note that a command came."""

    def pause(self) -> None:
        """Stop time."""

    def resume(self) -> None:
        """Let time run."""

    @property
    def paused(self) -> bool:
        """Whether time stands."""

    @property
    def owned(self) -> bool:
        """Whether stamps are simulated time, which can be set back."""

    def step(self, steps: int) -> tuple[str, int]:
        """Take so many plant steps while paused; return what was done and how many are still to come."""

    def step_periods(self, periods: int) -> None:
        """Let so many periods pass while paused: at once, or as commands come."""

    def set_factor(self, factor: float) -> None:
        """Change how fast time runs."""

    def report(self) -> tuple[dict[str, object], list[str]]:
        """Return values and troubles for /diagnostics."""


def _check_count(steps: int) -> None:
    if steps == 0:
        raise StepRefused("0 steps asked for; give at least 1")
    if steps > _MOST_STEPS:
        raise StepRefused(f"{steps} steps asked for, which would keep the node too long; give {_MOST_STEPS} at most")


class PacedTime:
    """The monotonic clock drives time; in mode `scaled` at a factor, with stamps in simulated time and /clock."""

    def __init__(self, node: SimNode, settings: Mapping[str, Value]) -> None:
        self._node = node
        self._stamps_are_simulated = settings["time_mode"] == "scaled"
        factor = settings["real_time_factor"] if self._stamps_are_simulated else 1.0
        self._pacer = Pacer(node.period, node.period, factor, settings["catch_up_limit"])
        self._paused = settings["start_paused"]
        self._offset = time.time_ns() - time.monotonic_ns()
        self._ahead = 0  # ns that stamps lead the wall clock by, so as not to go back with it
        self._latest = (0, 0)  # stamp and elapsed time of the latest state [ns]
        self._elapsed_at_origin = 0
        self._clock_steps = 0
        self._timer = node.create_timer(node.period, self._on_tick, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._started = False

    def _on_tick(self) -> None:
        if self._paused:
            return
        if not self._started:
            self.resume()  # counting starts with the first tick, not with the node's construction
            return
        for _ in range(self._pacer.due()):
            self._node.advance()

    def stamp(self) -> int:
        """Simulated time, or the wall-clock time at which the state was due: exact periods without jitter.

        A stamp never lies before the latest: where the wall clock is set back, or steps taken while paused have gone
        ahead of it, stamps go on by simulated time and stay ahead.
        """
        elapsed = self._node.elapsed
        if self._stamps_are_simulated:
            return elapsed
        offset = time.time_ns() - time.monotonic_ns()
        if abs(offset - self._offset) > _LARGEST_CLOCK_STEP:
            self._clock_steps += 1
            self._ahead = max(0, self._ahead - max(0, offset - self._offset))
            self._offset = offset
        stamp = self._offset + self._ahead + self._pacer.origin + elapsed - self._elapsed_at_origin
        earliest = self._latest[0] + max(0, elapsed - self._latest[1])
        if stamp < earliest:
            self._ahead += earliest - stamp
            stamp = earliest
        self._latest = (stamp, elapsed)
        return stamp

    def command_arrived(self) -> None:
        """Nothing to do: the next period takes the voltage in force."""

    def pause(self) -> None:
        """Stop time."""
        self._paused = True

    def resume(self) -> None:
        """Let time run from now."""
        self._started = True
        self._paused = False
        self._restart()

    def _restart(self) -> None:
        self._pacer.restart()
        self._elapsed_at_origin = self._node.elapsed

    def step(self, steps: int) -> tuple[str, int]:
        """Take the steps at once."""
        _check_count(steps)
        if not self._paused:
            raise StepRefused("the simulator is running; pause it first")
        self._node.step_plant(steps)
        return f"{steps} steps taken", 0

    @property
    def paused(self) -> bool:
        """Whether time stands."""
        return self._paused

    @property
    def owned(self) -> bool:
        """Whether stamps are simulated time: in mode `scaled`."""
        return self._stamps_are_simulated

    def step_periods(self, periods: int) -> None:
        """Take the periods at once."""
        for _ in range(periods):
            self._node.advance()

    def set_factor(self, factor: float) -> None:
        """Change how fast time runs in mode `scaled`; in real time there is nothing to scale."""
        if self._stamps_are_simulated:
            self._pacer.factor = factor

    def report(self) -> tuple[dict[str, object], list[str]]:
        """Lateness, overruns, lost time and the real-time factor."""
        health = self._pacer.report()
        values: dict[str, object] = {
            "paused": self._paused,
            "periods": health.periods,
            "overruns": health.overruns,
            "lost_time": health.lost_time,
            "real_time_factor": health.real_time_factor,
            "lateness_mean": health.lateness_mean,
            "lateness_p50": health.lateness_p50,
            "lateness_p99": health.lateness_p99,
            "lateness_p999": health.lateness_p999,
            "lateness_max": health.lateness_max,
            "clock_steps": self._clock_steps,
            "stamps_ahead": self._ahead / NANOSECONDS,
        }
        ahead = [f"stamps are {self._ahead / NANOSECONDS:.3g} s ahead of the wall clock"] if self._ahead else []
        return values, health.troubles() + ahead


class Lockstep:
    """Commands drive time: each period waits for exactly one command, and stamps are simulated time."""

    def __init__(self, node: SimNode, settings: Mapping[str, Value]) -> None:
        self._node = node
        self._patience = settings["lockstep_patience"]
        self._gate = LockstepGate(patience=self._patience, first_answer=FIRST_ANSWER)
        if settings["start_paused"]:
            self._gate.pause()
        self._tick_published = False
        self._told_uncommanded = 0
        self._told_waiting = False
        self._reported = (time.monotonic(), 0)
        check = min(_PEER_CHECK, self._patience / 2 or _PEER_CHECK)
        self._timer = node.create_timer(check, self._check_peers, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _check_peers(self) -> None:
        commanders, listeners = self._node.peers
        if self._gate.tick_wanted(commanders, listeners):
            self._publish_tick()
        elif self._gate.give_up(commanders):
            if self._gate.uncommanded == 1:
                self._node.get_logger().warning(
                    f"time now moves without commands, a period of {self._node.period:g} s every {self._patience:g} s"
                    " of the wall clock or slower, as a controller on a timer with use_sim_time:=true needs it"
                )
            self._node.advance()
        self._tell_waiting(commanders)

    def _tell_waiting(self, commanders: int) -> None:
        waiting = self._waiting(commanders)
        if waiting and not self._told_waiting:
            self._node.get_logger().warning(waiting)
        self._told_waiting = bool(waiting)

    def _waiting(self, commanders: int) -> str:
        """What to do where a command is awaited for long, with somebody there to send it; empty where none is."""
        if self._gate.waited(commanders) < LONG_WAIT:
            return ""
        what = f"no command for {LONG_WAIT:g} s, though a publisher is there: answer each joint_states with one command"
        if not self._patience:
            return f"{what}, or set lockstep_patience above 0 for a controller on a timer with use_sim_time:=true"
        longest = max(FIRST_ANSWER, self._patience)
        return f"{what}; after {longest:g} s time moves without one (lockstep_patience:=0.0: never)"

    def _publish_tick(self) -> None:
        self._tick_published = True
        self._node.publish_state()

    def _take(self) -> None:
        if not self._gate.take():
            return
        if not self._tick_published:
            self._publish_tick()
        self._node.advance()

    def stamp(self) -> int:
        """Simulated time."""
        return self._node.elapsed

    def command_arrived(self) -> None:
        """Take the period that waited for this command."""
        self._gate.command_arrived()
        self._take()

    def pause(self) -> None:
        """Hold the command of the next period until time runs again."""
        self._gate.pause()

    def resume(self) -> None:
        """Let periods pass as commands come."""
        self._gate.resume()
        self._take()

    def step(self, steps: int) -> tuple[str, int]:
        """Let so many steps pass as commands come."""
        _check_count(steps)
        periods, rest = divmod(steps, self._node.steps_per_period)
        if rest:
            raise StepRefused(f"{steps} steps are no whole number of periods of {self._node.steps_per_period} steps")
        if not self._gate.paused:
            raise StepRefused("the simulator is running; pause it first")
        self._gate.allow(periods)
        self._take()
        return f"{steps} steps, each period when its command comes", self._gate.allowance * self._node.steps_per_period

    @property
    def paused(self) -> bool:
        """Whether time stands."""
        return self._gate.paused

    @property
    def owned(self) -> bool:
        """Always: stamps are simulated time."""
        return True

    def step_periods(self, periods: int) -> None:
        """Let the periods pass as commands come."""
        self._gate.allow(periods)
        self._take()

    def set_factor(self, factor: float) -> None:
        """Nothing to do: commands set the pace."""

    def report(self) -> tuple[dict[str, object], list[str]]:
        """Whether a command is awaited, how fast time runs, and commands that came twice for a step or not at all."""
        (reported_at, elapsed), now = self._reported, time.monotonic()
        self._reported = (now, self._node.elapsed)
        simulated = (self._node.elapsed - elapsed) / NANOSECONDS
        values: dict[str, object] = {
            "paused": self._gate.paused,
            "waiting": self._gate.waiting,
            "real_time_factor": simulated / (now - reported_at) if now > reported_at else 0.0,
            "surplus_commands": self._gate.surplus,
            "periods_without_command": self._gate.uncommanded,
        }
        missed, self._told_uncommanded = self._gate.uncommanded - self._told_uncommanded, self._gate.uncommanded
        waiting = self._waiting(self._node.peers[0])
        troubles = [waiting] if waiting else []
        return values, troubles + ([f"{missed} periods taken without a command"] if missed else [])
