"""Samples put in order, against exhaustive search."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from eha_core.recording.samples import Samples, on_one_span, put_in_order


def ordered(stamps: list[int], values: list[float] | None = None) -> tuple[list[int], tuple[str, ...]]:
    numbers = np.array(values if values is not None else stamps, dtype=float)
    samples, remarks = put_in_order(Samples(np.array(stamps, dtype=np.int64), numbers))
    return samples.stamps.tolist(), remarks


def test_as_many_samples_as_possible_are_kept() -> None:
    generator = np.random.default_rng(5)
    for _ in range(60):
        stamps = generator.integers(0, 12, 9).tolist()
        longest = max(
            length
            for length in range(1, 10)
            for chosen in combinations(stamps, length)
            if all(a < b for a, b in zip(chosen, chosen[1:], strict=False))
        )
        kept, _ = ordered(stamps)
        assert len(kept) == longest
        assert kept == sorted(set(kept))


def test_a_wild_stamp_costs_only_itself() -> None:
    kept, remarks = ordered([0, 1, 10**15, 2, 3, 4])
    assert kept == [0, 1, 2, 3, 4]
    assert remarks == ("1 samples were left out because time runs backwards there",)


def test_a_sample_hours_away_from_the_rest_is_left_out() -> None:
    hour = 3600 * 10**9
    kept, remarks = ordered([0, 1, 2, 3, 5 * hour])
    assert kept == [0, 1, 2, 3]
    assert remarks == ("1 samples more than an hour away from the rest were left out",)


def test_a_clock_set_back_keeps_the_longer_side() -> None:
    kept, _ = ordered([*range(100, 130), *range(50, 100), *range(100, 110)])
    assert kept == [*range(50, 100), *range(100, 110)]


def test_nothing_is_kept_of_nothing() -> None:
    assert ordered([])[0] == []
    assert ordered([1, 2], [float("nan"), float("inf")])[0] == []


def test_a_single_step_back_by_one_ns_is_one() -> None:
    kept, remarks = ordered([0, 5, 4, 9, 10])
    assert len(kept) == 4 and remarks == ("1 samples were left out because time runs backwards there",)


def test_order_is_left_alone() -> None:
    stamps = list(range(0, 1000, 7))
    assert ordered(stamps) == (stamps, ())


def series(start: int, count: int) -> Samples:
    return Samples(np.arange(start, start + count, dtype=np.int64), np.arange(count, dtype=float))


def test_channels_that_kept_other_sides_of_a_leap_are_put_on_one_span() -> None:
    """Of ten samples each on two sides, position kept the later ones and one more, pressure the earlier ones."""
    both = Samples(np.array([*range(10), *range(1000, 1010)]), np.arange(20.0))
    ordered_channels = {"position": series(1000, 11), "pressure_a": series(0, 10), "force": series(5000, 3)}
    recorded = {"position": series(1000, 11), "pressure_a": both, "force": series(5000, 3)}
    kept, remarks = on_one_span(ordered_channels, recorded, ())
    assert kept["pressure_a"].stamps.tolist() == list(range(1000, 1010))
    assert kept["pressure_a"].values.tolist() == list(range(10, 20))
    assert kept.keys() == {"position", "pressure_a"}
    assert remarks == (
        "pressure_a: 10 samples of another time than position's were left out",
        "force was recorded at another time than position and was left out",
    )


def test_a_command_that_was_given_once_before_is_kept_and_overlapping_channels_are_left_alone() -> None:
    channels = {"voltage_command": series(0, 1), "position": series(500, 100), "pressure_a": series(550, 400)}
    assert on_one_span(channels, channels, ("voltage_command",)) == (channels, ())


def test_a_channel_that_has_no_number_in_the_span_of_the_longest_is_left_out() -> None:
    minute = 60 * 10**9
    stamps = np.arange(20, dtype=np.int64)
    late = np.array([3, 4, minute], dtype=np.int64)
    recorded = {
        "position": Samples(stamps, np.arange(20.0)),
        "velocity": Samples(late, np.array([np.nan, np.nan, 1.0])),
    }
    ordered_channels = {name: put_in_order(series)[0] for name, series in recorded.items()}
    kept, remarks = on_one_span(ordered_channels, recorded, ())
    assert list(kept) == ["position"]
    assert remarks == ("velocity was recorded at another time than position and was left out",)


HOUR = 3600 * 10**9


@pytest.mark.parametrize(("gap", "kept"), [(HOUR, 5), (HOUR + 1, 3)])
def test_a_gap_of_an_hour_is_one_run_and_a_longer_one_two(gap: int, kept: int) -> None:
    assert len(ordered([0, 1, 2, 2 + gap, 3 + gap])[0]) == kept
    assert ordered([0, 1, 1 + gap, 2 + gap, 3 + gap])[0][-kept:] == [0, 1, 1 + gap, 2 + gap, 3 + gap][-kept:]


def test_of_repeated_stamps_the_first_counts() -> None:
    samples, remarks = put_in_order(Samples(np.array([0, 1, 1, 1, 2, 2]), np.arange(6.0)))
    assert (samples.stamps.tolist(), samples.values.tolist()) == ([0, 1, 2], [0.0, 1.0, 4.0])
    assert remarks == ("3 samples with the stamp of the one before were left out",)


def test_values_go_with_their_stamps() -> None:
    numbers = [9.0, float("nan"), 7.0, 6.0, 5.0, 4.0]
    samples, remarks = put_in_order(Samples(np.array([5, 6, 7, 1, 8, 9]), np.array(numbers)))
    assert (samples.stamps.tolist(), samples.values.tolist()) == ([5, 7, 8, 9], [9.0, 7.0, 5.0, 4.0])
    assert remarks == (
        "1 samples that are not finite numbers were left out",
        "1 samples were left out because time runs backwards there",
    )


@pytest.mark.parametrize(
    ("first", "last", "is_kept"),
    [(99, 99, False), (99, 100, True), (199, 230, True), (200, 230, False), (0, 300, True)],
)
def test_a_channel_that_touches_the_span_of_the_longest_is_kept_as_it_is(first: int, last: int, is_kept: bool) -> None:
    """The longest goes from 100 to 199."""
    longest, other = (
        series(100, 100),
        Samples(np.array([first, last] if last > first else [first]), np.ones(2 - (first == last))),
    )
    channels = {"position": longest, "force": other}
    kept, remarks = on_one_span(channels, channels, ())
    assert ("force" in kept) == is_kept
    assert bool(remarks) == (not is_kept)


@pytest.mark.parametrize(("before", "is_kept"), [(1, True), (HOUR, True), (HOUR + 1, False)])
def test_a_command_holds_for_an_hour(before: int, is_kept: bool) -> None:
    command = Samples(np.array([0]), np.array([1.0]))
    channels = {"voltage_command": command, "position": series(before, 100)}
    kept, _ = on_one_span(channels, channels, ("voltage_command",))
    assert ("voltage_command" in kept) == is_kept
    late = {"voltage_command": Samples(np.array([before + 100]), np.array([1.0])), "position": series(before, 100)}
    assert list(on_one_span(late, late, ("voltage_command",))[0]) == ["position"]


def test_the_longest_is_one_that_is_measured_where_one_is() -> None:
    """However often the command was sent; alone it counts as it is."""
    channels = {"voltage_command": series(5 * HOUR, 500), "position": series(0, 10)}
    assert list(on_one_span(channels, channels, ("voltage_command",))[0]) == ["position"]
    alone = {"voltage_command": series(0, 5)}
    assert on_one_span(alone, alone, ("voltage_command",)) == (alone, ())


def test_what_of_a_channel_lies_in_the_span_of_the_longest_is_found_again() -> None:
    """Ends included: of 9, 10, 19 and 20 the two that lie from 10 to 19."""
    recorded = {"position": series(10, 10), "force": Samples(np.array([40, 41, 42, 9, 10, 19, 20]), np.arange(7.0))}
    ordered_channels = {"position": recorded["position"], "force": Samples(np.array([40, 41, 42]), np.arange(3.0))}
    kept, remarks = on_one_span(ordered_channels, recorded, ())
    assert (kept["force"].stamps.tolist(), kept["force"].values.tolist()) == ([10, 19], [4.0, 5.0])
    assert remarks == ("force: 5 samples of another time than position's were left out",)
