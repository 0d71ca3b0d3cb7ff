"""The tracker against numpy on complete data, for streams that arrive in any order."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.tracking import Tracker, TrackingSample

MS = 1_000_000


def feed(tracker: Tracker, arrivals: list[tuple[str, int, float]]) -> list[TrackingSample]:
    return [pair for stream, stamp, value in arrivals for pair in getattr(tracker, stream)(stamp, value)]


def streams(generator: np.random.Generator, count: int, offset: int = 0) -> tuple[np.ndarray, ...]:
    """Stamps and values of measured and reference samples; `offset` [ns] parts the two clocks' ticks."""
    stamps = np.arange(count) * 2 * MS
    return stamps + offset, generator.normal(size=count), stamps, generator.normal(size=count)


def interleaved(generator: np.random.Generator, data: tuple[np.ndarray, ...]) -> list[tuple[str, int, float]]:
    """Each stream in its own order, the two mixed at random with one up to hundreds of samples ahead."""
    measured = [("measured", int(t), float(v)) for t, v in zip(*data[:2], strict=True)]
    references = [("reference", int(t), float(v)) for t, v in zip(*data[2:], strict=True)]
    arrivals = []
    while measured or references:
        source = measured if not references or (measured and generator.random() < 0.5) else references
        run = int(generator.integers(1, 300))
        arrivals += source[:run]
        del source[:run]
    return arrivals


def shuffled(generator: np.random.Generator, data: tuple[np.ndarray, ...], reach: int) -> list[tuple[str, int, float]]:
    """Both streams by stamp, each sample late by up to `reach` [ns]."""
    everything = [("measured", int(t), float(v)) for t, v in zip(*data[:2], strict=True)]
    everything += [("reference", int(t), float(v)) for t, v in zip(*data[2:], strict=True)]
    return sorted(everything, key=lambda arrival: arrival[1] + generator.integers(0, reach))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("offset", [0, MS // 3])
def test_interleaving_does_not_matter(seed: int, offset: int) -> None:
    generator = np.random.default_rng(seed)
    data = streams(generator, 1500, offset)
    pairs = feed(Tracker(window=0.5), [*interleaved(generator, data), ("reference", int(data[2][-1]) + 100 * MS, 0.0)])
    last = 1500 if offset == 0 else 1499
    errors = data[1][:last] - np.interp(data[0][:last], data[2], data[3])
    np.testing.assert_allclose([pair.error for pair in pairs[:last]], errors, rtol=0, atol=1e-12)
    assert [pair.stamp for pair in pairs[:last]] == data[0][:last].tolist()
    for k in (0, 100, 900, last - 1):
        recent = errors[: k + 1][data[0][: k + 1] > data[0][k] - 500 * MS]
        assert pairs[k].rmse_window == pytest.approx(np.sqrt(np.mean(recent**2)), rel=1e-12)
        assert pairs[k].rmse == pytest.approx(np.sqrt(np.mean(errors[: k + 1] ** 2)), rel=1e-12)
        assert pairs[k].largest_error == pytest.approx(np.abs(errors[: k + 1]).max(), rel=1e-12)
        assert pairs[k].count == k + 1


@pytest.mark.parametrize("offset", [0, MS // 3])
def test_samples_late_within_their_stream_do_not_matter(offset: int) -> None:
    generator = np.random.default_rng(7)
    data = streams(generator, 1000, offset)
    tracker = Tracker(window=0.5, disorder=0.02)
    pairs = feed(tracker, [*shuffled(generator, data, 20 * MS), ("reference", int(data[2][-1]) + 100 * MS, 0.0)])
    errors = data[1] - np.interp(data[0], np.append(data[2], data[2][-1] + 100 * MS), np.append(data[3], 0.0))
    assert len(pairs) == 1000
    by_stamp = {pair.stamp: pair.error for pair in pairs}
    np.testing.assert_allclose([by_stamp[stamp] for stamp in data[0].tolist()], errors, rtol=0, atol=1e-12)
    recent = errors[data[0] > data[0][-1] - 500 * MS]
    assert pairs[-1].rmse_window == pytest.approx(np.sqrt(np.mean(recent**2)), rel=1e-12)
    assert pairs[-1].rmse == pytest.approx(np.sqrt(np.mean(errors**2)), rel=1e-12)


def test_small_errors_survive_a_large_one_that_left_the_window() -> None:
    tracker = Tracker(window=0.1)
    for k in range(500):
        tracker.reference(k * MS, 0.0)
        (pair,) = tracker.measured(k * MS, 1e9 if k < 10 else 1e-9)
    assert pair.rmse_window == pytest.approx(1e-9, rel=1e-14)
    assert pair.largest_error == 1e9


def test_a_reset_counts_from_here() -> None:
    tracker = Tracker()
    feed(tracker, [("reference", 0, 0.0), ("measured", 0, 5.0)])
    tracker.reset()
    (pair,) = feed(tracker, [("reference", MS, 0.0), ("measured", MS, 1.0)])
    assert (pair.rmse, pair.rmse_window, pair.largest_error, pair.count) == (1.0, 1.0, 1.0, 1)


def test_a_gap_in_the_reference_is_not_interpolated() -> None:
    tracker = Tracker(longest_gap=0.1)
    arrivals = [("reference", 0, 0.0), ("measured", 500 * MS, 1.0), ("reference", 1000 * MS, 0.0)]
    assert feed(tracker, [*arrivals, ("reference", 1100 * MS, 0.0)]) == []
    assert tracker.unpaired == 1


def test_a_measurement_before_every_reference_is_left_out() -> None:
    tracker = Tracker()
    feed(tracker, [("measured", 0, 1.0), ("reference", 10 * MS, 0.0), ("reference", 40 * MS, 0.0)])
    (pair,) = tracker.measured(40 * MS, 2.0)
    assert (pair.error, pair.count, tracker.unpaired) == (2.0, 1, 1)


def test_a_restarted_clock_pairs_with_the_new_references_only() -> None:
    tracker = Tracker()
    for k in range(100):
        feed(tracker, [("reference", k * MS, 0.0), ("measured", k * MS, 1.0)])
    assert feed(tracker, [("measured", 0, 7.0)]) == []
    (pair,) = feed(tracker, [("reference", 0, 4.0)])
    assert (pair.error, pair.rmse_window, pair.count) == (3.0, 3.0, 101)


def test_values_that_are_no_number_are_left_out() -> None:
    tracker = Tracker()
    assert feed(tracker, [("reference", 0, float("nan")), ("measured", 0, float("inf"))]) == []
    (pair,) = feed(tracker, [("reference", MS, 1.0), ("measured", MS, 1.5)])
    assert (pair.error, pair.count, tracker.unpaired) == (0.5, 1, 1)


def test_memory_stays_bounded_when_one_stream_falls_silent() -> None:
    for stream in ("measured", "reference"):
        tracker = Tracker()
        feed(tracker, [(stream, k * MS, 0.0) for k in range(30_000)])
        assert len(tracker._waiting.stamps) <= 5001
        assert len(tracker._references.stamps) <= 10_001
