"""Intervals follow the curvature where the residual is noise, and widen where it is coherent."""

from dataclasses import replace

import numpy as np
from made import recorded
from scipy.signal import lfilter

from eha_core.diagnosis.calibrate import calibrate
from eha_core.identification.intervals import with_residual
from eha_core.identification.observation import observe
from eha_core.identification.problem import linearise, normal_equations
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

OTHER = {"valve_gain": 2.2e-5, "damping_coefficient": 1800.0, "moving_mass": 10.0, "bulk_modulus": 1.2e9}


def deviations(recording) -> tuple[np.ndarray, np.ndarray]:
    """How far each of OTHER was found off, over its standard deviation from the curvature and from the residual too."""
    calibration = calibrate([observe(recording)], NominalModel(nominal_values()), 2e-4)
    fitted = calibration.fitted
    linear = linearise(calibration.problem, fitted.values, fitted.free, fitted.q, fitted.states)
    normal, _ = normal_equations(calibration.problem, fitted.free, fitted.q, fitted.states, linear)
    curved = replace(fitted, covariance=normal.covariance())
    wider = with_residual(calibration.problem, fitted)
    off = np.array([wider.values[name] - value for name, value in OTHER.items()])
    return tuple(off / [one.deviation(name) for name in OTHER] for one in (curved, wider))


def test_white_noise_widens_little() -> None:
    for seed in (1, 2):
        narrow, wide = deviations(recorded(OTHER, seed=seed))
        assert np.all(np.abs(wide) <= np.abs(narrow))
        assert np.all(np.abs(narrow) < 1.35 * np.abs(wide))


def test_noise_with_a_memory_is_covered() -> None:
    """Estimates scatter as far as their deviations say, and much farther than those from the curvature alone."""
    recording = recorded(OTHER, noise=0.0, duration=8.0)
    generator = np.random.default_rng(5)
    narrow, wide = zip(*(deviations(_with_coloured_noise(recording, generator)) for _ in range(8)), strict=True)
    assert np.sqrt(np.mean(np.square(narrow))) > 3.0
    assert 0.5 < np.sqrt(np.mean(np.square(wide))) < 1.5


def _with_coloured_noise(recording, generator):
    """Noise of first order: nine tenths of it stay from one sample to the next."""
    channels = dict(recording.channels)
    for name, level in (("position", 1e-5), ("pressure_a", 1e4), ("pressure_b", 1e4)):
        clean = channels[name]
        white = level * np.sqrt(1.0 - 0.9**2) * generator.standard_normal(len(clean.values))
        channels[name] = replace(clean, values=clean.values + lfilter([1.0], [1.0, -0.9], white))
    return replace(recording, channels=channels)
