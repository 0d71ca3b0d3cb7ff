"""Samples put in order, against exhaustive search."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from eha_core.recording.samples import Samples, put_in_order


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


def test_order_is_left_alone() -> None:
    stamps = list(range(0, 1000, 7))
    assert ordered(stamps) == (stamps, ())
