"""Pacing, the command input and the lockstep gate, against arithmetic done by hand on a clock that the test moves."""

from __future__ import annotations

import math

import pytest

from eha_core.realtime import NANOSECONDS, STEADY_ANSWERS, CommandInput, LockstepGate, Pacer

MILLISECOND = 1_000_000


class Hand:
    """A clock that stands still until the test moves it."""

    def __init__(self) -> None:
        self.now = 10 * NANOSECONDS

    def __call__(self) -> int:
        return self.now

    def move(self, milliseconds: float) -> None:
        self.now += round(milliseconds * MILLISECOND)


@pytest.fixture
def hand() -> Hand:
    return Hand()


def pacer(hand: Hand, **options: float) -> Pacer:
    return Pacer(period=0.002, tick=0.002, clock=hand, **options)


def test_a_punctual_timer_owes_one_period_a_tick(hand: Hand) -> None:
    pace = pacer(hand)
    owed = []
    for _ in range(1000):
        hand.move(2.0)
        owed.append(pace.due())
    assert owed == [1] * 1000
    health = pace.report()
    assert (health.periods, health.overruns, health.lost_time) == (1000, 0, 0.0)
    assert health.real_time_factor == pytest.approx(1.0, rel=1e-12)


def test_late_ticks_are_caught_up_with_exact_elapsed_time(hand: Hand) -> None:
    pace = pacer(hand)
    total = 0
    for late in [2.0, 9.3, 0.7, 2.4, 31.6, 2.0]:
        hand.move(late)
        total += pace.due()
    assert total == math.floor((2.0 + 9.3 + 0.7 + 2.4 + 31.6 + 2.0) / 2.0)
    assert pace.report().overruns == 2


def test_jitter_neither_gains_nor_loses_a_period_in_an_hour(hand: Hand) -> None:
    pace = pacer(hand)
    start, total = hand.now, 0
    for tick in range(7, 1_800_000, 7):  # every seventh tick of an hour, each up to 1 ms late
        hand.now = start + tick * 2 * MILLISECOND + (tick * 7919) % MILLISECOND
        total += pace.due()
    assert total == tick


def test_a_backlog_beyond_the_limit_is_lost_and_said_so(hand: Hand) -> None:
    pace = pacer(hand, catch_up_limit=0.1)
    hand.move(2.0)
    assert pace.due() == 1
    hand.move(1002.0)
    assert pace.due() == 51  # the period due and 100 ms of backlog
    health = pace.report()
    assert health.lost_time == pytest.approx(0.9)
    assert health.lateness_max == pytest.approx(0.1)
    hand.move(2.0)
    assert pace.due() == 1


def test_time_that_is_late_or_lost_is_told_once_and_punctual_time_is_not(hand: Hand) -> None:
    pace = pacer(hand, catch_up_limit=0.1)
    for _ in range(100):
        hand.move(2.0)
        pace.due()
    assert pace.report().troubles() == []
    for tick in range(100):  # six ticks in a hundred come 3 ms late, on top of what the last one left over
        hand.move(5.0 if tick % 17 == 0 else 2.0)
        pace.due()
    late = pace.report()
    assert late.overrun_share == pytest.approx(0.06)
    assert late.troubles()[0] == "6 % of the ticks came more than a period late"
    assert late.troubles()[1].startswith("one tick in a hundred was 4 ms late or more, with a period of 2 ms")
    hand.move(1002.0)
    pace.due()
    assert "0.9 s of time lost" in pace.report().troubles()[0]
    hand.move(2.0)
    pace.due()
    assert pace.report().troubles() == []


def test_a_timer_that_ticks_a_little_early_sets_the_phase_once(hand: Hand) -> None:
    pace = pacer(hand)
    hand.move(1.8)
    owed = [pace.due()]
    for _ in range(20):
        hand.move(2.0)
        owed.append(pace.due())
    assert owed == [1] * 21


def test_a_fast_timer_gains_no_time(hand: Hand) -> None:
    pace = pacer(hand)
    total = 0
    for _ in range(20_000):
        hand.move(1.7)
        total += pace.due()
    assert total <= 20_000 * 1.7 / 2.0 + 1


def test_a_factor_scales_simulated_time(hand: Hand) -> None:
    pace = pacer(hand, factor=4.0)
    hand.move(10.0)
    assert pace.due() == 20
    pace.factor = 0.5
    hand.move(16.0)
    assert pace.due() == 4


def test_lateness_is_measured_against_the_due_time(hand: Hand) -> None:
    pace = pacer(hand)
    for late in (0.0, 0.1, 0.3):
        hand.now = 10 * NANOSECONDS + round((2.0 + late) * MILLISECOND)
        pace.due()
        pace.restart()
        hand.now = 10 * NANOSECONDS
        pace.restart()
    health = pace.report()
    assert health.lateness_mean == pytest.approx(0.4e-3 / 3)
    assert health.lateness_max == pytest.approx(0.3e-3)


def test_lateness_is_told_by_percentiles(hand: Hand) -> None:
    """A thousand and one ticks, each a microsecond later than the one before it."""
    pace = pacer(hand)
    start = hand.now
    for tick in range(1, 1002):
        hand.now = start + 2 * tick * MILLISECOND + 1000 * (tick - 1)
        pace.due()
    health = pace.report()
    percentiles = health.lateness_p50, health.lateness_p99, health.lateness_p999, health.lateness_max
    assert percentiles == pytest.approx((500e-6, 990e-6, 999e-6, 1000e-6), rel=1e-6)


@pytest.mark.parametrize("voltage", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_refused_and_counted(voltage: float) -> None:
    command = CommandInput(limit=10.0, timeout=0.5)
    command.offer(0.25)
    command.offer(voltage)
    assert (command.voltage, command.accepted, command.refused) == (0.25, 1, 1)


@pytest.mark.parametrize(("voltage", "expected"), [(1e300, 10.0), (-10.5, -10.0)])
def test_what_passes_the_range_is_clamped_and_counted(voltage: float, expected: float) -> None:
    command = CommandInput(limit=10.0, timeout=0.5)
    command.offer(voltage)
    assert (command.voltage, command.accepted, command.clamped) == (expected, 1, 1)


def test_the_voltage_falls_to_zero_without_commands_and_comes_back() -> None:
    command = CommandInput(limit=10.0, timeout=0.5)
    for _ in range(1000):
        command.elapse(0.002)
    assert command.timeouts == 0  # nothing held, nothing to time out
    command.offer(1.0)
    for _ in range(249):
        command.elapse(0.002)
    assert command.voltage == 1.0
    command.elapse(0.002)
    assert (command.voltage, command.timeouts, command.holds) == (0.0, 1, False)
    command.offer(2.0)
    assert (command.voltage, command.holds) == (2.0, True)


def test_no_timeout_holds_for_ever() -> None:
    command = CommandInput(limit=10.0, timeout=0.0)
    command.offer(1.0)
    command.elapse(1e9)
    assert command.voltage == 1.0


def seconds(hand: Hand) -> LockstepGate:
    return LockstepGate(settle=0.2, clock=lambda: hand.now / NANOSECONDS)


def test_one_period_passes_for_each_command(hand: Hand) -> None:
    gate = seconds(hand)
    assert not gate.take()
    gate.command_arrived()
    assert gate.take()
    assert not gate.take()


def test_a_command_that_comes_while_paused_waits(hand: Hand) -> None:
    gate = seconds(hand)
    gate.pause()
    gate.command_arrived()
    assert not gate.take()
    gate.allow(2)
    assert gate.take()
    gate.command_arrived()
    assert gate.take()
    gate.command_arrived()
    assert gate.paused
    assert not gate.take()
    gate.resume()
    assert gate.take()


def test_the_first_tick_waits_until_the_peers_have_settled(hand: Hand) -> None:
    gate = seconds(hand)
    assert not gate.tick_wanted(0, 3)
    assert not gate.tick_wanted(1, 3)
    hand.move(150)
    assert not gate.tick_wanted(1, 4)  # still joining
    hand.move(150)
    assert not gate.tick_wanted(1, 4)
    hand.move(60)
    assert gate.tick_wanted(1, 4)
    hand.move(1000)
    assert not gate.tick_wanted(1, 4)  # once, while nothing changes


def test_a_late_joiner_gets_the_tick_until_a_command_shows_it_was_heard(hand: Hand) -> None:
    gate = seconds(hand)
    gate.tick_wanted(1, 1)
    hand.move(300)
    assert gate.tick_wanted(1, 1)
    gate.tick_wanted(1, 2)
    hand.move(300)
    assert gate.tick_wanted(1, 2)
    gate.command_arrived()
    assert gate.take()
    gate.tick_wanted(1, 3)  # a recorder joins while the controller thinks
    hand.move(300)
    assert not gate.tick_wanted(1, 3)


def test_a_commander_that_is_started_again_gets_the_tick(hand: Hand) -> None:
    gate = seconds(hand)
    gate.tick_wanted(1, 1)
    hand.move(300)
    assert gate.tick_wanted(1, 1)
    gate.command_arrived()
    gate.take()
    assert not gate.tick_wanted(0, 0)
    assert not gate.tick_wanted(1, 1)
    hand.move(300)
    assert gate.tick_wanted(1, 1)


def test_no_tick_goes_out_while_paused(hand: Hand) -> None:
    gate = seconds(hand)
    gate.pause()
    gate.tick_wanted(1, 1)
    hand.move(1000)
    assert not gate.tick_wanted(1, 1)
    gate.resume()
    assert gate.tick_wanted(1, 1)


def test_a_second_command_for_one_step_is_counted(hand: Hand) -> None:
    gate = seconds(hand)
    gate.pause()
    gate.command_arrived()
    gate.command_arrived()
    assert gate.surplus == 1


def test_a_command_that_does_not_come_is_waited_for_as_long_as_patience_lasts(hand: Hand) -> None:
    gate = LockstepGate(patience=0.1, clock=lambda: hand.now / NANOSECONDS)
    assert not gate.give_up(commanders=1)  # nobody was asked yet
    gate.tick_wanted(1, 1)
    hand.move(300)
    assert gate.tick_wanted(1, 1)
    hand.move(90)
    assert not gate.give_up(1)
    hand.move(20)
    assert not gate.give_up(0)  # nobody is there to be waited for
    assert gate.give_up(1)
    assert not gate.give_up(1)
    gate.command_arrived()
    hand.move(500)
    assert not gate.give_up(1)
    assert gate.take()
    gate.pause()
    hand.move(500)
    assert not gate.give_up(1)
    gate.resume()
    assert not gate.give_up(1)
    hand.move(110)
    assert gate.give_up(1) and gate.uncommanded == 2


def test_a_controller_that_answers_no_tick_is_waited_for_once_and_one_that_does_again(hand: Hand) -> None:
    gate = LockstepGate(patience=0.01, first_answer=5.0, clock=lambda: hand.now / NANOSECONDS)
    gate.tick_wanted(1, 1)
    hand.move(300)
    assert gate.tick_wanted(1, 1)
    hand.move(4990)
    assert not gate.give_up(1) and gate.waited(1) == pytest.approx(4.99) and gate.waited(0) == 0.0
    hand.move(20)
    assert gate.give_up(1) and gate.on_clock
    hand.move(11)
    assert gate.give_up(1)
    for _ in range(STEADY_ANSWERS):
        assert gate.on_clock
        gate.command_arrived()
        assert gate.take()
    hand.move(4990)
    assert not gate.on_clock and not gate.give_up(1)
    hand.move(20)
    assert gate.give_up(1) and gate.uncommanded == 3
