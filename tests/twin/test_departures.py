"""When a departure is named, and from which seconds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.twin import Comparison
from eha_core.twin.departures import LEAST, MOST, UNCERTAIN, Departures
from eha_core.twin.excerpt import Excerpt
from eha_core.twin.explanation import Departure
from eha_core.twin.samples import nanoseconds


def window(number: int) -> Excerpt:
    start, end = nanoseconds(number), nanoseconds(number + 1)
    stamps = np.arange(start, end, nanoseconds(0.01))
    series = (stamps, np.zeros(len(stamps)))
    return Excerpt(start, end, (stamps[:1], np.ones(1)), {"position": series, "pressure_a": series})


class Run:
    """Windows of a second, one after the other."""

    def __init__(self) -> None:
        self._departures = Departures()
        self._windows: list[Excerpt] = []

    def next(self, since: float | None, unsound: Mapping[str, tuple[str, int]] | None = None) -> Departure | None:
        self._windows.append(window(len(self._windows)))
        newest = self._windows[-1]
        departs = {} if since is None else {"force balance": nanoseconds(since)}
        noises = {name: 1e-5 for name in newest.channels if name not in (unsound or {})}
        comparison = Comparison(newest.start, newest.end, {}, noises, {}, departs, unsound or {})
        return self._departures.take(comparison, self._windows, {"moving_mass": 9.0})


def test_it_is_named_at_once_and_again_when_half_as_much_more_is_known() -> None:
    run = Run()
    assert run.next(None) is None
    first = run.next(1.1)
    assert first is not None and first.parameters == {"moving_mass": 9.0}
    assert (first.excerpt.start, first.excerpt.end) == (nanoseconds(1.1 + UNCERTAIN), nanoseconds(2.0))
    again = [number for number in range(2, 40) if run.next(1.1) is not None]
    assert again == [2, 3, 5, 8]  # from 1.8, 2.8, 4.8 and 7.8 s; the most there is are not half as much more
    assert run.next(None) is None
    assert run.next(40.1) is not None  # another departure


def test_it_is_named_from_so_many_seconds_at_most_and_at_least() -> None:
    run = Run()
    assert not any(run.next(None) for _ in range(20))
    departure = run.next(3.0)
    assert departure is not None and departure.excerpt.end - departure.excerpt.start == nanoseconds(MOST)
    late = Run()
    assert late.next(1.0 - LEAST) is None  # the uncertain tenth of it does not count
    assert late.next(1.0 - LEAST) is not None


def test_seconds_with_a_sensor_that_stood_still_are_left_out() -> None:
    run = Run()
    frozen = {"pressure_a": ("frozen", nanoseconds(1.0))}
    assert run.next(0.0) is not None
    during = run.next(0.0, frozen)
    assert during is None or set(during.noises) == {"position"}
    run.next(0.0, frozen)
    while (after := run.next(0.0)) is None:
        pass
    assert set(after.noises) == {"position", "pressure_a"} and after.excerpt.start >= nanoseconds(3.0)
