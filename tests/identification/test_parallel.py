"""What does not depend on each other runs side by side, in order and on its own below that."""

import threading
import time

import pytest

from eha_core.identification.parallel import each, side_by_side, threads


def test_without_threads_each_is_done_in_turn():
    assert threads() == 1
    assert each(lambda number: number**2, iter(range(4))) == [0, 1, 4, 9]
    assert each(lambda number: number, []) == []


def test_results_and_announcements_keep_their_order():
    announced: list[float] = []

    def late(seconds: float) -> float:
        time.sleep(seconds)
        return seconds

    waits = [0.05, 0.0, 0.02, 0.0]
    with side_by_side(2):
        assert threads() == 2
        assert each(late, waits, announced.append) == waits
    assert announced == waits and threads() == 1


def test_two_run_at_once_and_what_they_split_up_runs_on_their_own_thread():
    both = threading.Barrier(2, timeout=5.0)

    def task(_: int) -> tuple[int, set[str]]:
        both.wait()  # passed only when two are here
        return threads(), set(each(lambda _: threading.current_thread().name, range(3)))

    with side_by_side(2):
        (_, first), (_, second) = found = each(task, range(2))
    assert [count for count, _ in found] == [1, 1]
    assert len(first) == len(second) == 1 and first != second


def test_an_error_is_raised_where_its_result_is_waited_for():
    def fail(number: int) -> int:
        if number == 1:
            raise ArithmeticError("one")
        return number

    with side_by_side(2), pytest.raises(ArithmeticError, match="one"):
        each(fail, range(3))
