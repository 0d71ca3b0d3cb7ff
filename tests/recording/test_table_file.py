"""Columns of a table as channels: what counts as seconds, what is recognised, and what is refused."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import ChannelRule
from eha_core.recording.table_file import channels_of, stamps_of
from eha_core.recording.topics_file import TopicsFile
from eha_core.tables import Table

DAY = 86400 * 10**9


NOTHING_SAID = ChannelRule()


def stamped(times: object, rule: ChannelRule = NOTHING_SAID, stated: str = "") -> tuple[list[int], tuple[str, ...]]:
    stamps, remarks = stamps_of("run: column 'time'", np.asarray(times), rule, stated)
    return stamps.tolist(), remarks


def by(step: float, count: int = 20, first: float = 0.0) -> list[float]:
    return [first + k * step for k in range(count)]


@pytest.mark.parametrize(("step", "count"), [(0.999, 20), (1.0, 19), (500.0, 19), (1e-4, 400), (0.0, 30), (-0.01, 30)])
def test_steps_below_a_second_or_few_times_are_seconds(step: float, count: int) -> None:
    stamps, remarks = stamped(by(step, count, 5.0))
    assert stamps == [round(1e9 * (5.0 + k * step)) for k in range(count)]
    assert remarks == ()


@pytest.mark.parametrize("step", [1.0, 2.0, -2.0, 19_999.0, 2e4, 9e5])
def test_longer_steps_are_no_seconds_and_open(step: float) -> None:
    with pytest.raises(
        RecordingError, match=rf"goes by steps of {re.escape(f'{abs(step):.4g}')}, which are not seconds; say its unit"
    ):
        stamped(by(step))


@pytest.mark.parametrize("step", [1e6, 2e6])
def test_steps_that_only_ns_can_have_are_ns(step: float) -> None:
    stamps, remarks = stamped(by(step))
    assert stamps == [round(k * step) for k in range(20)]
    assert remarks == (f"run: column 'time' goes by steps of {step:.4g} and was taken as ns",)


@pytest.mark.parametrize(
    ("first", "unit", "factor"),
    [
        (1e12, "ms", 10**6),
        (3.9e12, "ms", 10**6),
        (1e15, "us", 1000),
        (3.9e15, "us", 1000),
        (1e18, "ns", 1),
        (3.9e18, "ns", 1),
    ],
)
def test_counts_since_1970_are_told_by_their_size(first: float, unit: str, factor: int) -> None:
    times = np.array([int(first) + 4096 * k for k in range(20)])
    stamps, remarks = stamped(times)
    assert stamps == [int(one) * factor for one in times]
    assert remarks == (f"run: column 'time' goes by steps of 4096 and was taken as {unit} since 1970",)


@pytest.mark.parametrize("first", [0.99e12, 4e12, 0.99e15, 4e15, 0.99e18])
def test_counts_of_no_year_from_2001_to_2096_are_open(first: float) -> None:
    with pytest.raises(RecordingError, match="which are not seconds"):
        stamped(np.array([int(first) + 4096 * k for k in range(20)]))


@pytest.mark.parametrize(
    ("stated", "ns", "is_said"),
    [("s", 10**9, False), ("ms", 10**6, True), ("us", 1000, True), ("ns", 1, False), ("min", 60 * 10**9, True)],
)
def test_the_file_s_own_word_comes_first(stated: str, ns: int, is_said: bool) -> None:
    stamps, remarks = stamped(by(20_000.0), stated=stated)
    assert stamps == [20_000 * k * ns for k in range(20)]
    assert remarks == ((f"run: column 'time' was taken as {stated}, as the file says",) if is_said else ())
    assert stamped(by(0.5), stated="mm") == stamped(by(0.5))


@pytest.mark.parametrize(
    ("rule", "stamps"),
    [
        (ChannelRule(scale=1e-3), [0, 2_000_000]),
        (ChannelRule(offset=3.0), [3 * 10**9, 5 * 10**9]),
        (ChannelRule(scale=1e-3, offset=-1.0), [-(10**9), -998_000_000]),
        (ChannelRule(unit="s"), [0, 2 * 10**9]),
    ],
)
def test_a_topics_file_s_word_is_the_last(rule: ChannelRule, stamps: list[int]) -> None:
    found, remarks = stamped(by(2.0), rule, "us")
    assert (found[:2], remarks) == (stamps, ())


def test_whole_ns_are_kept_to_the_last() -> None:
    times = np.array([1_700_000_000_000_000_001 + 7 * k for k in range(5)])
    assert stamped(times, stated="ns")[0] == times.tolist()
    shifted, _ = stamped(times, ChannelRule(scale=1e-9, offset=1.0))
    assert np.diff(shifted).tolist() == [7] * 4
    assert abs(shifted[0] - times[0] - 10**9) < 1000


@pytest.mark.parametrize("times", [[0.0, 4.62e9], [4.62e9, 0.0], [-4.62e9, -4.62e9], [0.0, 1e300], [1e19, 1e19]])
def test_times_146_years_away_are_beyond_any_calendar(times: list[float]) -> None:
    with pytest.raises(RecordingError, match="is beyond any calendar"):
        stamped(times)
    assert len(stamped([0.0, 4.61e9])[0]) == 2
    assert stamped([4.61e9, 4.61e9 + 1.0])[0] == [4_610_000_000_000_000_000, 4_610_000_001_000_000_000]


def a_table(**columns: object) -> Table:
    return Table("csv", {name: np.asarray(values, dtype=float) for name, values in columns.items()}, {}, ("a remark",))


def test_columns_are_channels_by_their_names_or_as_the_topics_file_says() -> None:
    table = a_table(time=[0.0, np.nan, 0.2], position=[1.0, 2.0, 3.0], x=[4.0, 5.0, 6.0], force=[7.0, 8.0, 9.0])
    samples, rules, remarks = channels_of(Path("run.csv"), table, None)
    assert {name: one.values.tolist() for name, one in samples.items()} == {"position": [1.0, 3.0], "force": [7.0, 9.0]}
    assert samples["force"].stamps.tolist() == [0, 200_000_000] and remarks == (
        "a remark",
        "1 rows without a time in 'time' were left out",
    )
    given = TopicsFile({"position": ChannelRule(column="x", scale=1e-3, offset=1.0), "force": None})
    samples, rules, _ = channels_of(Path("run.csv"), table, given)
    assert {name: one.values.tolist() for name, one in samples.items()} == {"position": [4.0, 6.0]}
    assert rules["position"] == ChannelRule("x", None, "x", 1e-3, 1.0)
    timed = TopicsFile({}, None, ChannelRule(column="x"))
    assert channels_of(Path("run.csv"), table, timed)[0]["force"].stamps.tolist() == [4 * 10**9, 5 * 10**9, 6 * 10**9]


@pytest.mark.parametrize(("count", "end"), [(30, r"c28\)"), (31, r"c28 and 1 more\)"), (35, r"c28 and 5 more\)")])
def test_of_many_columns_thirty_are_listed(count: int, end: str) -> None:
    table = a_table(start=[1.0], **{f"c{k}": [1.0] for k in range(count - 1)})
    with pytest.raises(RecordingError, match=rf"run.csv: no column 'time' \(start, c0, .*{end}; name the times"):
        channels_of(Path("run.csv"), table, None)


def test_what_is_not_there_is_refused_by_name() -> None:
    with pytest.raises(RecordingError, match="no column 'y' for channel position; there are time, x"):
        channels_of(Path("run.csv"), a_table(time=[0.0], x=[1.0]), TopicsFile({"position": ChannelRule(column="y")}))
    with pytest.raises(RecordingError, match="column 'time' holds no numbers"):
        channels_of(Path("run.csv"), a_table(time=[np.nan], x=[1.0]), None)
    with pytest.raises(RecordingError, match="'position' for channel position has 2 values and the time 'time' has 1"):
        channels_of(Path("run.csv"), a_table(time=[0.0], position=[1.0, 2.0]), None)
