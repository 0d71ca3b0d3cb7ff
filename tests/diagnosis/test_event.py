"""A span in which alone the nominal model fails is an event."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from eha_core.diagnosis.event import event

WINDOWS, EACH = 12, 200


def left(*loud: int, times: float = 5.0):
    """Two channels of twelve windows of 1 s: noise, and so many times as much in some windows of the second."""
    window = np.repeat(np.arange(WINDOWS), EACH)
    noise = np.random.default_rng(3).standard_normal((2, len(window)))
    noise[1, np.isin(window, loud)] *= times
    sampling = SimpleNamespace(window=window)
    shooting = SimpleNamespace(
        windows=WINDOWS, samplings=(sampling, sampling), edges=5000 * np.arange(WINDOWS + 1), step_size=2e-4
    )
    after = noise.copy()
    after[1, np.isin(window, loud)] /= times
    return shooting, SimpleNamespace(residuals=tuple(noise)), SimpleNamespace(residuals=tuple(after))


@pytest.mark.parametrize(
    ("loud", "span"),
    [
        ((3, 4), (3.0, 5.0)),
        ((11,), (11.0, 12.0)),
        ((3, 5), (3.0, 6.0)),
        ((), None),
        ((2, 9), None),
        ((2, 3, 4, 5, 6), None),
        (tuple(range(WINDOWS)), None),
    ],
)
def test_an_event_is_one_span_of_a_third_of_the_recording_at_most(loud, span):
    assert event(*left(*loud)) == (pytest.approx(span) if span else None)


def test_what_is_hardly_more_than_noise_is_none():
    assert event(*left(3, times=1.2)) is None


def test_a_short_recording_has_none():
    shooting, *fits = left(3)
    shooting.windows = 5
    assert event(shooting, *fits) is None


def test_what_explains_more_at_other_times_too_is_none():
    """As behind a filter, where the noise is taken as it was before it."""
    shooting, nominal, winner = left(3)
    winner.residuals[0][:] *= 0.5
    assert event(shooting, nominal, winner) is None
