"""A moving average is found from the zeros in its spectrum, and only where there was one."""

from __future__ import annotations

import numpy as np
import pytest
from benches import TIME, motion, velocity
from measured import CURRENTS, DATA, TESTS, needs_dampers, processed, raw, raw_at_5_hz
from scipy.io import loadmat
from scipy.signal import butter, lfilter

from eha_core.motion_given.averaging import averaging_window

V = velocity(TIME)
RAW = 150.0 * np.sign(V) + 900.0 * V + 2.0 * np.random.default_rng(1).standard_normal(len(TIME))


def averaged(values: np.ndarray, window: int) -> np.ndarray:
    return np.convolve(values, np.ones(window) / window, "same")


@pytest.mark.parametrize("window", [8, 20, 33, 50, 120])
@pytest.mark.parametrize("resolution", [0.01, 0.1])
def test_the_window_is_found_to_the_sample(window: int, resolution: float) -> None:
    assert averaging_window(resolution * np.round(averaged(RAW, window) / resolution)) == window


def test_the_motion_need_not_be_a_sine() -> None:
    generator = np.random.default_rng(4)
    wandering = np.cumsum(np.cumsum(generator.standard_normal(6000))) + generator.standard_normal(6000)
    assert averaging_window(averaged(wandering, 25)) == 25
    assert averaging_window(wandering) is None


@pytest.mark.parametrize("order", [1, 2, 4, 8])
@pytest.mark.parametrize("corner", [0.05, 0.2, 0.5])
def test_a_low_pass_filter_is_not_an_average(order: int, corner: float) -> None:
    assert averaging_window(lfilter(*butter(order, corner), RAW)) is None


def test_what_turns_the_force_round_late_is_not_an_average() -> None:
    late = np.interp(TIME - 0.02, TIME, RAW)
    compliant = lfilter([0.1], [1.0, -0.9], RAW)
    heavy = RAW + 12.0 * np.gradient(V, TIME)
    for force in (RAW, np.round(RAW), late, compliant, heavy):
        assert averaging_window(force) is None


def test_white_noise_is_hardly_ever_an_average() -> None:
    generator = np.random.default_rng(9)
    assert not any(averaging_window(generator.standard_normal(size)) for size in [250, 1000, 4000] * 60)


def test_too_few_or_no_values_have_no_window() -> None:
    assert averaging_window(np.zeros(500)) is None
    assert averaging_window(np.arange(25000) / 1000.0) is None
    assert averaging_window(np.arange(30.0) ** 2) is None


def test_a_motion_knows_the_window_and_then_no_noise() -> None:
    plain, smooth = motion(RAW), motion(averaged(RAW, 40), noise=0.0)
    assert plain.averaged is None
    assert plain.noise == pytest.approx(2.0 * np.sqrt(2.0), rel=0.1)
    assert smooth.averaged == pytest.approx(40 / 500.0)
    assert smooth.noise is None
    assert smooth.position_averaged is None


@needs_dampers
@pytest.mark.parametrize("test", TESTS)
@pytest.mark.parametrize("current", CURRENTS)
def test_each_processed_recording_shows_its_authors_average(test: str, current: str) -> None:
    recorded = processed(test, current)
    assert recorded.averaged is not None and recorded.period is not None
    assert 0.095 < recorded.averaged / recorded.period < 0.114
    assert recorded.position_averaged == recorded.averaged


@needs_dampers
def test_no_raw_recording_shows_one() -> None:
    for recorded in (raw(0), raw(4), raw_at_5_hz()):
        assert recorded.averaged is None and recorded.position_averaged is None
        assert recorded.noise is not None and recorded.noise > 0.0


@pytest.mark.skipif(not (DATA / "labcontrol_mr_damper").is_dir(), reason="no recordings beside the project")
def test_another_laboratorys_raw_force_shows_none() -> None:
    for name in "AB":
        force = loadmat(DATA / "labcontrol_mr_damper" / f"ensaio.{name}.1.mat")["forc"].ravel()
        assert averaging_window(force) is None
