"""What makes a simulated rig run like a real one: pacing against a clock, its lateness, and the drive's command input.

Nothing here sleeps or waits: a timer calls in, and these objects say how much simulated time is owed, which voltage is
in force and, in lockstep, whether the next period may be taken. So all of it is exact and testable without a clock.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

NANOSECONDS = 1_000_000_000


LONG_WAIT = 1.0
"""Wall-clock seconds in lockstep after which a command that does not come, with somebody there to send it, is reported:
assumed, more than a controller's step takes."""
FIRST_ANSWER = 5.0
"""Wall-clock seconds until a controller that answers no tick is taken for one on the simulated clock, which waits for
time to pass: assumed, as long as a controller needs to load and compile."""
STEADY_ANSWERS = 50
"""Ticks answered one after the other by which a controller is known to answer each: assumed."""
OVERRUN_SHARE = 0.05
"""Share of late ticks from which a controller sees another rig than the one simulated: assumed, one in twenty."""


@dataclass(frozen=True)
class Health:
    """How well real time was kept since the previous report (lateness) and since the start (counts).

    Lateness is how long after its due time a period was taken [s], its mean, percentiles (p999: 99.9 %) and maximum: of
    a controller's thousand periods a second, one meets the 99.9th. `overruns` counts calls that found more than one
    period owed; `lost_time` is simulated time given up because the backlog passed the catch-up limit [s];
    `real_time_factor` is simulated over wall-clock time since the previous report, and so are `overrun_share`, the
    share of calls that were overruns, and `newly_lost_time`. `wall_period` is the wall-clock time of one period [s].
    """

    periods: int
    overruns: int
    lost_time: float
    real_time_factor: float
    lateness_mean: float
    lateness_p50: float
    lateness_p99: float
    lateness_p999: float
    lateness_max: float
    overrun_share: float
    newly_lost_time: float
    wall_period: float

    def troubles(self) -> list[str]:
        """Why the simulated time since the previous report is not a rig's: one line each, none when all is well."""
        troubles = []
        if self.newly_lost_time > 0.0:
            troubles.append(f"{self.newly_lost_time:.3g} s of time lost: the machine is too busy")
        if self.overrun_share > OVERRUN_SHARE:
            troubles.append(f"{100 * self.overrun_share:.0f} % of the ticks came more than a period late")
        if self.lateness_p99 > self.wall_period:
            troubles.append(
                f"one tick in a hundred was {1e3 * self.lateness_p99:.2g} ms late or more, with a period of"
                f" {1e3 * self.wall_period:.2g} ms"
            )
        return troubles


class Pacer:
    """Tells how many periods of simulated time are owed, from exact elapsed time and never from counted ticks.

    Args:
        period: simulated time per period [s].
        tick: wall-clock time between two calls of `due` [s]; only sets how early a call may be and still count.
        factor: simulated seconds per wall-clock second.
        catch_up_limit: the largest backlog that is made up for [s of wall-clock]; what lies beyond it is lost.
        clock: monotonic clock [ns].
    """

    def __init__(
        self,
        period: float,
        tick: float,
        factor: float = 1.0,
        catch_up_limit: float = 0.5,
        clock: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._period = period
        self._tick_ns = tick * NANOSECONDS
        self._factor = factor
        self.catch_up_limit = catch_up_limit
        self._limit_ns = catch_up_limit * NANOSECONDS
        self._clock = clock
        self._periods = 0
        self._overruns = 0
        self._lost_ns = 0.0
        self._lateness_ns: list[float] = []
        self._reported = (clock(), 0, 0, 0.0)
        self.restart()

    @property
    def factor(self) -> float:
        """Simulated seconds per wall-clock second."""
        return self._factor

    @factor.setter
    def factor(self, value: float) -> None:
        self._factor = value
        self.restart()

    @property
    def origin(self) -> int:
        """When the periods since the last restart began, on the pacer's clock [ns]; time that was lost moves it on."""
        return round(self._origin_ns + self._phase_ns)

    def restart(self) -> None:
        """Count from now: nothing is owed (at the start, after a pause, when the factor changes)."""
        self._origin_ns = float(self._clock())
        self._done = 0
        self._phase_ns = 0.0  # how far the timer's phase was found before the origin

    def due(self) -> int:
        """Return the number of whole periods owed now, and take them as done."""
        now = self._clock()
        wall_period = self._period / self._factor * NANOSECONDS
        late = now - (self._origin_ns + (self._done + 1) * wall_period)
        if -min(self._tick_ns / 2 - self._phase_ns, self._tick_ns / 4) <= late < 0:
            # The first tick of a timer is often its latest one; the pacer then takes over the timer's phase, or every
            # second tick would come just too early. The shift is bounded, so time cannot be gained again and again.
            self._origin_ns += late
            self._phase_ns -= late
            late = 0.0
        if late < 0:
            return 0
        if late > self._limit_ns:
            self._origin_ns += late - self._limit_ns
            self._lost_ns += (late - self._limit_ns) * self._factor
            late = self._limit_ns
        owed = int(late / wall_period) + 1
        self._done += owed
        self._periods += owed
        self._overruns += owed > max(1, round(self._tick_ns / wall_period))
        self._lateness_ns.append(late)
        return owed

    def report(self) -> Health:
        """Return the health since the previous report and start a new one."""
        now = self._clock()
        reported_at, periods, overruns, lost_ns = self._reported
        self._reported = (now, self._periods, self._overruns, self._lost_ns)
        wall = (now - reported_at) / NANOSECONDS
        simulated = (self._periods - periods) * self._period
        calls = len(self._lateness_ns)
        lateness = np.asarray(self._lateness_ns or [0.0]) / NANOSECONDS
        half, most, nearly_all = (float(quantile) for quantile in np.quantile(lateness, (0.5, 0.99, 0.999)))
        self._lateness_ns = []
        return Health(
            periods=self._periods,
            overruns=self._overruns,
            lost_time=self._lost_ns / NANOSECONDS,
            real_time_factor=simulated / wall if wall > 0 else 0.0,
            lateness_mean=float(lateness.mean()),
            lateness_p50=half,
            lateness_p99=most,
            lateness_p999=nearly_all,
            lateness_max=float(lateness.max()),
            overrun_share=(self._overruns - overruns) / calls if calls else 0.0,
            newly_lost_time=(self._lost_ns - lost_ns) / NANOSECONDS,
            wall_period=self._period / self._factor,
        )


class CommandInput:
    """The drive's voltage input: refuses what is no number, clamps to its range, and falls to zero without commands.

    Args:
        limit: largest magnitude the drive takes [V].
        timeout: simulated time without a command after which the voltage falls to zero [s]; 0 waits for ever.

    `accepted`, `refused`, `clamped` and `timeouts` count since the start.
    """

    def __init__(self, limit: float, timeout: float) -> None:
        self.limit = limit
        self.timeout = timeout
        self.voltage = 0.0
        self.accepted = 0
        self.refused = 0
        self.clamped = 0
        self.timeouts = 0
        self._age: float | None = None  # None: no command holds, so none can run out

    @property
    def holds(self) -> bool:
        """Whether a command is in force (false before the first one and after a timeout)."""
        return self._age is not None

    def offer(self, voltage: float) -> None:
        """Take a command [V]; a refused one leaves the voltage in force as it was."""
        if not math.isfinite(voltage):
            self.refused += 1
            return
        self.accepted += 1
        self.clamped += abs(voltage) > self.limit
        self.voltage = min(max(voltage, -self.limit), self.limit)
        self._age = 0.0

    def elapse(self, seconds: float) -> None:
        """Let simulated time pass [s]."""
        if self._age is None:
            return
        self._age += seconds
        # Half a nanosecond of slack: the age is a sum of periods and the timeout often a multiple of one.
        if 0 < self.timeout <= self._age + 0.5 / NANOSECONDS:
            self.timeouts += 1
            self.release()

    def release(self) -> None:
        """Drop the command in force: the voltage is zero until the next one."""
        self.voltage = 0.0
        self._age = None


class LockstepGate:
    """Lets one period pass for each command, and says when the tick that asks for a command goes out.

    The simulator publishes a tick (its state), waits for one command, advances one period and publishes the next tick.
    Messages are lost to peers that have not found each other yet, so a tick is (re)published once the set of peers has
    been still for `settle` seconds after a change, until a command shows that somebody hears it. A new commander starts
    this again; a recorder that joins while a controller is thinking does not.

    A controller that is itself driven by the simulated clock needs time to pass before it commands. With a `patience`
    [s], the first period whose command does not come within `first_answer` [s] (`patience`, where that is longer) may
    be taken all the same, and from then on each whose command does not come within `patience`, until `STEADY_ANSWERS`
    ticks in a row were answered. `uncommanded` counts the periods without a command.
    """

    def __init__(
        self,
        settle: float = 0.2,
        patience: float = 0.0,
        clock: Callable[[], float] = time.monotonic,
        first_answer: float = 0.0,
    ) -> None:
        self._settle = settle
        self._patience = patience
        self._first_answer = max(first_answer, patience)
        self._clock = clock
        self._answers = STEADY_ANSWERS  # ticks answered since the latest that was not
        self._ticked_at: float | None = None
        self._peers: tuple[int, int] = (0, 0)
        self._changed_at: float | None = None
        self._heard = False
        self._pending = False
        self._allowance: int | None = None
        self.surplus = 0
        self.uncommanded = 0

    @property
    def allowance(self) -> int:
        """How many periods may pass before the next pause; 0 as well where none is set."""
        return self._allowance or 0

    @property
    def waiting(self) -> bool:
        """Whether the simulator waits for a command."""
        return not self._pending

    @property
    def paused(self) -> bool:
        """Whether no further period may pass."""
        return self._allowance == 0

    @property
    def on_clock(self) -> bool:
        """Whether the controller lets ticks pass unanswered, as one on the simulated clock does."""
        return self._answers < STEADY_ANSWERS

    def waited(self, commanders: int) -> float:
        """How long the command of this tick has not come, though somebody is there to send it [s]; 0 while paused."""
        if self.paused or self._pending or not commanders or self._ticked_at is None:
            return 0.0
        return self._clock() - self._ticked_at

    def pause(self) -> None:
        """Let no period pass until `resume` or `allow`."""
        self._allowance = 0

    def resume(self) -> None:
        """Let periods pass as commands come."""
        self._allowance = None
        self._be_patient_again()

    def allow(self, periods: int) -> None:
        """Let so many periods pass as commands come, then pause."""
        self._allowance = periods
        self._be_patient_again()

    def _be_patient_again(self) -> None:
        if self._ticked_at is not None:
            self._ticked_at = self._clock()

    def command_arrived(self) -> None:
        """Note the command of this step; a second one before the step is taken replaces it and is counted."""
        self.surplus += self._pending
        self._pending = True
        self._heard = True

    def take(self) -> bool:
        """Return whether a period may pass now, and use up its command and its allowance."""
        if not self._pending or self._allowance == 0:
            return False
        self._pending = False
        self._answers += 1
        self._use_period()
        return True

    def give_up(self, commanders: int) -> bool:
        """Return whether the period may pass without its command, which the matched commanders have kept for too
        long."""
        longest = self._patience if self.on_clock else self._first_answer
        if not self._patience or self.waited(commanders) < longest:
            return False
        self._answers = 0
        self._use_period()
        self.uncommanded += 1
        return True

    def _use_period(self) -> None:
        if self._allowance is not None:
            self._allowance -= 1
        self._ticked_at = self._clock()

    def tick_wanted(self, commanders: int, listeners: int) -> bool:
        """Return whether the tick should be published (again), given the numbers of matched peers now."""
        now = self._clock()
        if commanders > self._peers[0]:
            self._heard = False
        if (commanders, listeners) != self._peers:
            self._peers = (commanders, listeners)
            self._changed_at = now
        if self._heard or self._pending or self._changed_at is None or commanders == 0 or listeners == 0:
            return False
        if self.paused or now - self._changed_at < self._settle:
            return False
        self._changed_at = None
        self._ticked_at = now
        return True
