"""Stage 2, calibrate: the nominal equations with their parameters free, so that a wrong value is not taken for
physics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.fit import Fit, fit, fit_in_stages, with_noise
from eha_core.diagnosis.freedom import nominal_freedom
from eha_core.diagnosis.noise import residual_noise
from eha_core.diagnosis.observation import RESOLVED, Observation
from eha_core.diagnosis.problem import Problem, whole
from eha_core.diagnosis.shooting import Shooting, cut
from eha_core.parameters import NOMINAL

NOTICEABLE = 4.0
"""A parameter has changed when it left its nominal value by this many standard deviations ..."""

RELEVANT = 0.01
"""... and by this share of itself (or, where the nominal value is zero, of the scale on which it is free)."""


@dataclass(frozen=True)
class Calibration:
    """The windows, the nominal model as given (only starts fitted), and the nominal equations at their best."""

    shooting: Shooting
    problem: Problem
    nominal: Fit
    fitted: Fit


def calibrate(observation: Observation, nominal: Mapping[str, float], step_size: float) -> Calibration:
    """Fit the nominal equations; correct each channel's noise by what the residual's roughness shows; fit again."""
    shooting = cut(observation, nominal, step_size)
    position = observation.channel("position")
    assert position is not None
    free = nominal_freedom(nominal, observation.drive, float(np.max(np.abs(position.values))))
    first = fit_in_stages(whole(shooting), nominal, free)
    shooting = with_noise(shooting, corrected_noise(shooting, first))
    problem = whole(shooting)
    fitted = fit(problem, first.values, free, first.states, iterations=8)
    as_given = fit(problem, nominal, (), fitted.states, iterations=5)
    return Calibration(shooting, problem, as_given, fitted)


def corrected_noise(shooting: Shooting, result: Fit) -> list[float]:
    """The noise that the residual's second differences show, within a factor two of what the channel itself showed."""
    return [
        max(one.noise * float(np.clip(residual_noise(residual), 0.5, 2.0)), RESOLVED["Pa" if one.column > 1 else "m"])
        for one, residual in zip(shooting.samplings, result.residuals, strict=True)
    ]


def identifiable(result: Fit, name: str) -> bool:
    """Whether the recording says more about a parameter than its nominal value did."""
    place = [one.name for one in result.free].index(name)
    return bool(np.sqrt(max(result.covariance[place, place], 0.0)) < 0.5 * result.free[place].trust)


def has_changed(result: Fit, nominal: Mapping[str, float], name: str) -> bool:
    """Whether a fitted parameter has left its nominal value, noticeably and relevantly."""
    place = [one.name for one in result.free].index(name)
    one = result.free[place]
    departure = abs(result.values[name] - nominal[name])
    relevant = RELEVANT * (abs(nominal[name]) if one.logarithmic else max(abs(nominal[name]), one.scale))
    return departure > NOTICEABLE * result.deviation(name) and departure > relevant


UNITS = {row.name: row.unit for row in NOMINAL}
