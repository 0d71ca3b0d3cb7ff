"""Series made ready to be looked at."""

from __future__ import annotations

import numpy as np

from eha_core.report.series import autocorrelation, pieces, strongest_dependence, thinned

TIME = np.arange(50_000) * 1e-3


def test_thinning_keeps_every_peak_and_the_order() -> None:
    values = np.sin(TIME)
    values[12_345], values[40_001] = 9.0, -7.0
    x, y = thinned(TIME, values, 1000)
    assert len(x) <= 1000
    assert y.max() == 9.0
    assert y.min() == -7.0
    assert np.all(np.diff(x) > 0.0)
    assert np.array_equal(y, values[np.searchsorted(TIME, x)])


def test_short_series_are_left_alone() -> None:
    x, y = thinned(TIME[:100], TIME[:100], 1000)
    assert np.array_equal(x, TIME[:100])
    assert np.array_equal(y, TIME[:100])


def test_pieces_hold_only_the_spans_and_are_not_joined() -> None:
    x, y = pieces(TIME, TIME, ((1.0, 2.0), (5.0, 6.0)))
    kept = np.isfinite(y)
    assert np.all(((x[kept] >= 1.0) & (x[kept] < 2.0)) | ((x[kept] >= 5.0) & (x[kept] < 6.0)))
    assert np.count_nonzero(~kept) == 2


def test_no_span_holds_a_sample() -> None:
    x, y = pieces(TIME, TIME, ((100.0, 101.0),))
    assert len(x) == len(y) == 0


def test_a_residual_s_variable_is_found_with_the_share_it_explains() -> None:
    generator = np.random.default_rng(3)
    speed, other = generator.standard_normal((2, len(TIME)))
    residual = np.sign(speed) + generator.standard_normal(len(TIME))
    found = strongest_dependence(TIME, residual, {"velocity": speed, "position": other, "time": TIME})
    assert found is not None
    assert found.variable == "velocity"
    assert abs(found.share - 0.5) < 0.03  # equal variances of law and noise
    assert np.allclose(
        found.means[np.abs(found.centres) > 0.5], np.sign(found.centres[np.abs(found.centres) > 0.5]), atol=0.1
    )


def test_noise_depends_on_nothing() -> None:
    generator = np.random.default_rng(4)
    time = TIME[:300]
    found = strongest_dependence(
        time, generator.standard_normal(300), {"velocity": generator.standard_normal(300), "time": time}
    )
    assert found is not None
    assert found.share < 0.06


def test_autocorrelation_of_a_first_order_process_survives_missing_samples() -> None:
    generator = np.random.default_rng(5)
    values = np.zeros(len(TIME))
    shocks = generator.standard_normal(len(TIME))
    for k in range(1, len(values)):
        values[k] = 0.8 * values[k - 1] + shocks[k]
    there = generator.random(len(TIME)) > 0.1
    lag, correlation = autocorrelation(TIME[there], values[there], 5)
    assert np.allclose(lag, np.arange(1, 6) * 1e-3)
    assert np.allclose(correlation, 0.8 ** np.arange(1, 6), atol=0.03)
