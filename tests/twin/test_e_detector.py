"""The twin's rule: how often it alarms by chance, whenever it is looked at, and what it needs for an alarm."""

import numpy as np
import pytest
from scipy.stats import norm

from eha_core.twin.e_detector import CLIPPED, TIMES_LARGER, Detector, log_e_value


@pytest.mark.parametrize("deviation", [0.3, 1.0, 1.5])
def test_a_windows_evidence_has_a_mean_of_at_most_one_while_the_model_holds(deviation: float) -> None:
    values = deviation * np.random.default_rng(1).standard_normal((200_000, 3))
    means = np.exp(log_e_value(values, 1.5))
    assert np.mean(means) < 1.0 + 3.0 * np.std(means) / np.sqrt(len(means))


def test_of_one_value_and_one_size_it_is_the_ratio_of_two_normal_densities() -> None:
    ratios = [norm.pdf(2.7, scale=1.5 * times) / norm.pdf(2.7, scale=1.5) for times in TIMES_LARGER]
    assert log_e_value(np.array([-2.7]), 1.5) == pytest.approx(np.log(np.mean(ratios)))
    assert log_e_value(np.array([]), 1.5) == 0.0


def windows_to_an_alarm(windows: float, deviation: float, seed: int, at_most: int = 10_000) -> int:
    detector = Detector(windows)
    logs = log_e_value(deviation * np.random.default_rng(seed).standard_normal((10_000, 8)), 1.0)
    for number in range(1, at_most):
        detector.weigh(float(logs[number]))
        if detector.is_alarmed:
            return number
    return at_most


def test_alarms_by_chance_are_as_far_apart_in_the_mean_as_was_asked() -> None:
    """Of a residual that is just as large as allowed, the worst that is still none."""
    found = [windows_to_an_alarm(50.0, 1.0, seed) for seed in range(100)]
    assert np.mean(found) > 50.0
    assert np.mean([windows_to_an_alarm(50.0, 0.7, seed, 2000) for seed in range(20)]) > 1500.0


def test_twice_what_is_allowed_is_an_alarm_within_some_windows_and_a_single_spike_is_none() -> None:
    century = 24.0 * 365.0 * 100.0 * 3600.0
    assert np.mean([windows_to_an_alarm(century, 2.0, seed) for seed in range(50)]) < 8.0
    spiked = Detector(4.0 * 3600.0 * 10_000.0)
    spiked.weigh(log_e_value(np.array([0.1, -0.4, 1e6, 0.2, 0.0, 0.3, -0.1, 0.5]), 1.0))
    assert not spiked.is_alarmed
    assert log_e_value(np.array([1e6]), 1.0) == log_e_value(np.array([CLIPPED]), 1.0)


def test_an_alarm_ends_with_the_first_window_that_speaks_for_the_model() -> None:
    detector = Detector(1e9)
    for _ in range(20):
        detector.weigh(50.0)
    assert detector.is_alarmed and detector.is_suspicious
    detector.weigh(-1.0)
    assert not detector.is_alarmed and detector.is_suspicious
    for _ in range(30):
        detector.weigh(-1.0)
    assert not detector.is_suspicious
