"""A second process that does things in their order, and what is heard of one that fails or ends."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator

import pytest

from eha_core.background import NICENESS, Background, Done
from eha_core.errors import EhaError


@pytest.fixture
def background() -> Iterator[Background]:
    made = Background(os.getpid)
    yield made
    made.close(0.0)


def done(background: Background, count: int) -> list[Done]:
    """So many results, within half a minute."""
    found, deadline = list[Done](), time.monotonic() + 30.0
    while len(found) < count and time.monotonic() < deadline:
        found += background.results()
        time.sleep(0.005)
    return found


def test_things_are_done_elsewhere_in_their_order_and_nobody_waits(background: Background) -> None:
    began = time.monotonic()
    jobs: list[tuple[Callable[..., object], tuple[object, ...]]] = [
        (time.sleep, (0.3,)),
        (len, ("abc",)),
        (int, ("x",)),
    ]
    for function, arguments in jobs:
        background.submit(function, *arguments)
    assert background.results() == [] and time.monotonic() - began < 0.2
    (prepared, pid), *results = done(background, 4)
    assert prepared is os.getpid and pid != os.getpid()
    assert os.getpriority(os.PRIO_PROCESS, pid) == min(os.getpriority(os.PRIO_PROCESS, 0) + NICENESS, 19)
    assert [function for function, _ in results] == [time.sleep, len, int]
    assert results[1][1] == 3 and isinstance(results[2][1], ValueError)
    assert background.is_idle


def test_a_process_that_has_ended_is_an_error_and_no_standstill(background: Background) -> None:
    ((_, pid),) = done(background, 1)
    background.submit(time.sleep, 60.0)
    background.results()
    os.kill(pid, signal.SIGKILL)
    background.submit(len, "abc")
    outcomes = [outcome for _, outcome in done(background, 2)]
    assert len(outcomes) == 2 and all(isinstance(outcome, EhaError) for outcome in outcomes)


def test_an_interrupt_of_the_terminal_does_not_end_it_and_an_end_waits_for_what_is_under_way() -> None:
    background = Background(os.getpid)
    ((_, pid),) = done(background, 1)
    os.kill(pid, signal.SIGINT)
    background.submit(len, "abc")
    assert background.close(30.0) == [(len, 3)]
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
