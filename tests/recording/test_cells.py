"""Cells of text as numbers and instants, and what lines state, against the standard library."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone

import numpy as np
import pytest

from eha_core.recording.time_units import unwrapped, usual_step
from eha_core.tables.gathered_columns import GatheredColumn, loses_by_value
from eha_core.tables.number_cells import is_number, number_of
from eha_core.tables.stated import rate_in, unit_in
from eha_core.tables.time_cells import instants_of, is_instant


@pytest.mark.parametrize(
    ("cell", "decimal", "expected"),
    [
        ("1.5", ".", 1.5),
        ("-.5", ".", -0.5),
        ("5.", ".", 5.0),
        ("+1e-3", ".", 1e-3),
        ("1,5", ",", 1.5),
        ("1,234.5", ".", 1234.5),
        ("1,234,567", ".", 1234567.0),
        ("1.234,5", ",", 1234.5),
        ("1'234.5", ".", 1234.5),
        ("1 234,5", ",", 1234.5),
        ("-10,499.930", ".", -10499.93),
        ("inf", ".", np.inf),
        ("1,5", ".", None),
        ("1.5", ",", None),
        ("0,123", ".", None),
        ("12,34.5", ".", None),
        ("1,2345", ".", None),
        ("1,234'567", ".", None),
        ("", ".", None),
        ("ERR", ".", None),
        ("12:30", ".", None),
        ("1.2.3", ".", None),
        ("0x1F", ".", None),
        ("1e", ".", None),
        ("--5", ".", None),
        ("1_000_00", ".", None),
    ],
)
def test_a_cell_is_the_number_that_is_written(cell: str, decimal: str, expected: float | None) -> None:
    found = number_of(cell, decimal)
    assert (found and found[0]) == expected
    assert is_number(cell, decimal) == (expected is not None and np.isfinite(expected))


@pytest.mark.parametrize(
    ("cell", "scaled", "value", "behind"),
    [
        ("25.1m", True, 0.0251, ""),
        ("10.2k", True, 10200.0, ""),
        ("3u", True, 3e-6, ""),
        ("2M", True, 2e6, ""),
        ("25.1 mm", True, 25.1, "mm"),
        ("25.1m", False, 25.1, "m"),
        ("12 bar", False, 12.0, "bar"),
        ("5%", False, 5.0, "%"),
    ],
)
def test_what_stands_behind_a_number(cell: str, scaled: bool, value: float, behind: str) -> None:
    found = number_of(cell, ".", scaled)
    assert found is not None and found[0] == pytest.approx(value) and found[1] == behind


START = datetime(2026, 11, 26, 21, 4, 52, 123000, tzinfo=timezone.utc)
FORMS = [
    "%Y-%m-%dT%H:%M:%S.%fZ",
    "%Y-%m-%d %H:%M:%S.%f",
    "%Y/%m/%d %H:%M:%S.%f",
    "%d.%m.%Y %H:%M:%S,%f",
    "%d.%m.%y %H:%M:%S.%f",
    "%m/%d/%Y %I:%M:%S.%f %p",
    "%m/%d/%Y %H:%M:%S.%f",
    "%d-%m-%Y %H:%M:%S.%f",
    "%d-%b-%Y %H:%M:%S.%f",
    "%d %B %Y %H:%M:%S.%f",
    "%b %d, %Y %H:%M:%S.%f",
    "%a %b %d %Y %H:%M:%S.%f",
    "%Y-%m-%d;%H:%M:%S.%f",
    "%Y-%m-%d_%H:%M:%S.%f",
]
"""Each writes a date and a clock; the 26th tells the day from the month."""


@pytest.mark.parametrize("form", FORMS)
def test_a_date_is_the_instant_that_it_names(form: str) -> None:
    instants = [START + timedelta(milliseconds=7 * k) for k in range(20)]
    texts = np.array([instant.strftime(form) for instant in instants], dtype=object)
    assert all(map(is_instant, texts))
    found = instants_of(texts)
    assert found.known.all() and found.has_date and found.has_clock and found.other is None
    epoch = datetime(1970, 1, 1, tzinfo=timezone.utc)
    assert found.stamps.tolist() == [(instant - epoch) // timedelta(microseconds=1) * 1000 for instant in instants]


@pytest.mark.parametrize("hour", [0, 1, 11, 12, 13, 23])
@pytest.mark.parametrize("form", ["%I:%M:%S %p", "%I:%M:%S%p", "%H:%M:%S"])
def test_noon_and_midnight_of_a_clock_of_twelve_hours(hour: int, form: str) -> None:
    text = datetime(2026, 1, 1, hour, 30, 15).strftime(form)
    found = instants_of(np.array([text], dtype=object))
    assert found.stamps.tolist() == [(hour * 3600 + 30 * 60 + 15) * 10**9]


@pytest.mark.parametrize(
    "cell", ["", "12", "12.5", "1.2", "12:30", "13/13/2026", "0/5/2026", "2026", "1-2", "a:b:c", "99 Foo 2026", "-1.5"]
)
def test_what_is_no_instant(cell: str) -> None:
    assert not is_instant(cell)


def test_a_date_among_others_that_is_none_is_not_known() -> None:
    texts = np.array(["2026-11-26 10:00:00.5", "", "n/a", "2026-02-31 10:00:00.5", "2026-11-26 10:00:01"], dtype=object)
    found = instants_of(texts)
    assert found.known.tolist() == [True, False, False, False, True]
    assert found.stamps[4] - found.stamps[0] == 500_000_000


@pytest.mark.parametrize(
    ("line", "rate"),
    [
        ("Sample rate: 500 Hz", 500.0),
        ("SampleRate[Hz],1000", 1000.0),
        ("Abtastrate [kHz];1", 1000.0),
        ("Sampling Frequency = 2 kHz", 2000.0),
        ("# fs: 250", 250.0),
        ("Sampling Interval: 0.002", 500.0),
        ("Sample interval (ms): 2", 500.0),
        ("dt = 0.001 s", 1000.0),
        ("Delta_X\t0,001", 1000.0),
        ("Sampling interval,1,ms", 1000.0),
        ('"Sample Rate","100"', 100.0),
        ("Scan rate: 10 S/s", 10.0),
        ("Sampling Interval: 2", None),
        ("Channels: 4", None),
        ("Rated flow: 40 l/min", None),
        ("Sample rate: fast", None),
        ("Sample rate: 0 Hz", None),
        ("Interval: 5 bar", None),
        ("Rate of flow: 5 l/min", None),
        ("Heart rate: 60 bpm", None),
    ],
)
def test_the_rate_that_a_line_states(line: str, rate: float | None) -> None:
    assert rate_in(["Device: logger", line]) == (None if rate is None else pytest.approx(rate))


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("p_A [bar]", "bar"),
        ("Command (V) - Plot 0", "V"),
        ("pressure(bar)/HeadSide_P", "bar"),
        ("In1 (1)", ""),
        ("X[0]", ""),
        ("stroke [Skt]", "Skt"),
        ("druck_a (raw data)", ""),
        ("x [\u00b5m]", "\u00b5m"),
        ("p [bar(g)]", "bar(g)"),
        ("p", ""),
    ],
)
def test_only_a_unit_is_a_unit(name: str, unit: str) -> None:
    assert unit_in(name) == unit


@pytest.mark.parametrize("period", [256, 65536, 1000, 86_400_000])
@pytest.mark.parametrize("kind", [np.int64, np.float64])
def test_a_counter_that_begins_anew_goes_on(period: int, kind: type) -> None:
    straight = np.arange(0, 3 * period, max(1, period // 50))
    times, remark = unwrapped((straight % period).astype(kind))
    np.testing.assert_array_equal(times, straight)
    assert "2 times" in remark and times.dtype == kind


def test_a_clock_that_is_set_back_does_not() -> None:
    times = np.concatenate([np.arange(100.0, 200.0), np.arange(130.0, 230.0)])
    found, remark = unwrapped(times)
    np.testing.assert_array_equal(found, times)
    assert remark == "" and usual_step(times) == 0.0


def test_gaps_at_the_edge_are_told_from_gaps_anywhere() -> None:
    """Against a thousand series of random gaps, of which hardly any may look like an overflow."""
    generator = np.random.default_rng(1)
    values = np.sin(np.arange(2000) * 0.05)
    taken = 0
    for _ in range(1000):
        missing = np.zeros(2000, dtype=bool)
        missing[generator.integers(0, 2000, 8)] = True
        taken += loses_by_value(np.where(missing, np.nan, values), missing)
    assert taken <= 2
    lost = values > 0.9
    assert loses_by_value(np.where(lost, np.nan, values), lost)


def gathered(*blocks: list[str]) -> GatheredColumn:
    column = GatheredColumn("Time")
    for block in blocks:
        cells = np.array(block, dtype=object)
        column.add(cells, *column.read(cells))
    return column


def seconds(*days: datetime) -> list[int]:
    return [round((day - datetime(1970, 1, 1)).total_seconds()) for day in days]


def test_a_date_further_on_tells_the_order_of_all_before_it() -> None:
    column = gathered(["04/05/2026 10:00:00", "04/05/2026 10:00:01"], ["04/13/2026 10:00:00"])
    values, remark = column.values("a.csv")
    april = datetime(2026, 4, 5, 10)
    expected = seconds(april, april + timedelta(seconds=1), april + timedelta(days=8))
    assert (values // 10**9).tolist() == expected and not remark and column.other_order is None


def test_an_order_that_moves_no_sample_is_assumed_and_said() -> None:
    column = gathered(["04/05/2026 10:00:00", "04/05/2026 10:00:01"])
    values, remark = column.values("a.csv")
    assert (values // 10**9).tolist() == seconds(datetime(2026, 5, 4, 10), datetime(2026, 5, 4, 10, 0, 1))
    assert remark == "assumed: Time: the day stands before the month (2026-05-04), which moves no sample"
    assert column.other_order is None


@pytest.mark.parametrize("day_first", [True, False])
def test_an_order_that_moves_samples_is_open(day_first: bool) -> None:
    form = "%d/%m/%Y %H:%M:%S" if day_first else "%m/%d/%Y %H:%M:%S"
    instants = [datetime(2026, 4, 5, 23, 59, 59), datetime(2026, 4, 6)]
    column = gathered([instant.strftime(form) for instant in instants])
    values, _ = column.values("a.csv")
    assert (values // 10**9).tolist() == seconds(*instants)
    assert column.other_order is not None and column.other_order.day_first is day_first
    other = [datetime(2026, 5, 4, 23, 59, 59), datetime(2026, 6, 4)]
    assert (column.other_order.swapped // 10**9).tolist() == seconds(*other)
