"""Topics brought onto one clock: where the stamps leap, and how far clocks may lie apart."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.recording.clocks import on_one_clock, without_leaps
from eha_core.recording.topic_columns import DecodedTopic

MS, SECOND = 10**6, 10**9
HOUR = 3600 * SECOND


def a_topic(name: str, stamps: list[int], logged: list[int], lead: int = 0) -> DecodedTopic:
    numbers = {"position": np.arange(len(stamps), dtype=float)}
    return DecodedTopic(name, np.array(stamps, dtype=np.int64), np.array(logged, dtype=np.int64), lead, numbers, ())


def leaping(leap: int, before: int = 12, after: int = 20, period: int = 10 * MS) -> DecodedTopic:
    logged = [k * period for k in range(before + after)]
    return a_topic("/a", [at + (leap if k >= before else 0) for k, at in enumerate(logged)], logged)


@pytest.mark.parametrize(
    ("leap", "is_one"),
    [
        (-150 * MS, False),  # a step of -100 ms of the median of five messages, which 10 ms lie between
        (-151 * MS, True),
        (-40 * SECOND, True),
        (HOUR, False),
        (HOUR + 1, True),
        (SECOND, False),
    ],
)
def test_a_leap_is_a_step_back_of_more_than_100_ms_or_of_an_hour_ahead(leap: int, is_one: bool) -> None:
    topic = leaping(leap)
    (kept,), remarks = without_leaps([topic])
    if not is_one:
        assert kept is topic and remarks == ()
        return
    assert remarks == ("the clock of the stamps leapt; 12 messages before or after were left out",)
    assert kept.logged.tolist() == topic.logged[12:].tolist()
    assert kept.stamps.tolist() == topic.stamps[12:].tolist()
    assert kept.columns["position"].tolist() == list(range(12, 32))
    assert kept.lead == -leap


def test_the_fuller_side_is_kept_of_every_topic_though_one_has_less_there() -> None:
    before = a_topic("/b", [k * MS for k in range(200)], [k * MS for k in range(200)], 7)
    topics, remarks = without_leaps([leaping(-SECOND), before])
    assert [len(topic.stamps) for topic in topics] == [12, 120]
    assert remarks == ("the clock of the stamps leapt; 100 messages before or after were left out",)
    assert [topic.lead for topic in topics] == [0, 0]


def test_a_topic_with_nothing_on_the_kept_side_keeps_its_lead() -> None:
    late = a_topic("/b", [200 * MS], [200 * MS], 7)
    topics, _ = without_leaps([leaping(-SECOND, before=20, after=10), late])
    assert [len(topic.stamps) for topic in topics] == [20, 0]
    assert [topic.lead for topic in topics] == [0, 7]


@pytest.mark.parametrize("wild", [1, 2, 3])
def test_two_messages_out_of_order_are_no_leap_and_three_are(wild: int) -> None:
    topic = leaping(0)
    stamps = topic.stamps.copy()
    stamps[10 : 10 + wild] -= SECOND
    _, remarks = without_leaps([a_topic("/a", stamps.tolist(), topic.logged.tolist())])
    assert bool(remarks) == (wild == 3)


def test_log_times_that_go_back_themselves_are_no_leap_of_the_stamps() -> None:
    logged = [*(k * MS for k in range(10)), *(k * MS - SECOND for k in range(10, 20))]
    assert without_leaps([a_topic("/a", logged, logged)])[1] == ()
    held = [*(k * MS for k in range(10)), *(9 * MS for _ in range(10))]  # written at once
    stamps = [*(k * MS for k in range(10)), *(k * MS - SECOND for k in range(10, 20))]
    assert without_leaps([a_topic("/a", stamps, held)])[1] != ()


@pytest.mark.parametrize(("apart", "is_shifted"), [(0, False), (SECOND, False), (SECOND + 1, True), (5 * SECOND, True)])
def test_clocks_more_than_a_second_apart_are_set_by_the_log_times(apart: int, is_shifted: bool) -> None:
    stamps = [0, MS, 2 * MS]
    topics = [
        a_topic("/a", stamps, [at + SECOND for at in stamps], SECOND),
        a_topic("/b", stamps, [at + SECOND + apart for at in stamps], SECOND + apart),
        a_topic("/c", [], [], 99 * SECOND),
    ]
    found, remarks = on_one_clock(topics)
    if not is_shifted:
        assert found == topics and remarks == ()
        return
    for one, before in zip(found, topics, strict=True):
        assert one.stamps.tolist() == before.logged.tolist() and one.lead == 0
    assert remarks == (
        f"the clocks of /a, /b lie up to {apart / 1e9:.3g} s apart; their stamps were set by the log times",
    )


def test_without_a_message_no_clock_is_changed() -> None:
    empty = [a_topic("/a", [], [], 5 * SECOND)]
    assert on_one_clock(empty) == (empty, ()) and without_leaps(empty) == (empty, ())
    assert on_one_clock([]) == ([], ())
