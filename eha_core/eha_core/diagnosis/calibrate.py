"""Stage 2, calibrate: fit the parameters of the nominal equations, so that a wrong value is not taken for physics."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eha_core.diagnosis.criteria import AT_ALL, BEHIND_A_FILTER, ENOUGH, NEAR_NOISE, NOTICEABLE, NOWHERE_ELSE, RELEVANT
from eha_core.health.noise import residual_noise
from eha_core.identification.colour import colour_of
from eha_core.identification.fit import WORTH, Fit, fit, fit_in_stages, with_noise
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.identification.observation import RESOLVED, SHORTEST, Observation, without_end
from eha_core.identification.per_recording import base_name, named
from eha_core.identification.problem import Problem, whole
from eha_core.identification.shooting import Shooting
from eha_core.identification.short_windows import SHORT
from eha_core.identification.together import cut_together, fit_alone, recording_alone
from eha_core.nominal import NominalModel

STEPS = (2e-4, 1e-4, 5e-5)
"""s; the step sizes at which hypotheses may be compared. At the first the oil's natural frequency is right to fourth
order; large flows or a fast valve can need the others."""

SAMPLES_A_WINDOW = 45.0
"""Samples of all channels in the shortest window: eleven for each free initial state. With fewer, the initial states
fit anything (assumed)."""


@dataclass(frozen=True)
class Calibration:
    """The windows, the nominal model as given (only initial states fitted) and the recalibrated one; `shorter` windows
    of the same recordings, of the lengths `short_windows.SHORT`."""

    shooting: Shooting
    problem: Problem
    nominal: Fit
    fitted: Fit
    shorter: tuple[Shooting, ...] = ()


def calibrate(
    observations: Sequence[Observation],
    model: NominalModel,
    step_size: float = STEPS[0],
    begun: Fit | None = None,
) -> Calibration:
    """Fit the nominal equations, correct each channel's noise level by the residual's roughness, and fit again.

    `begun`: a fit at another step size, the initial guess in place of the nominal values.
    """
    nominal = model.values
    shooting = cut_together(observations, nominal, step_size, per_recording=model.per_recording)
    positions = [
        channel.values for observation in observations for channel in observation.measured if channel.name == "position"
    ]
    farthest = max(float(np.max(np.abs(values))) for values in positions)
    free = free_nominal_parameters(nominal, shooting.drive, farthest, model.unknown, shooting.composition)
    if begun is None:
        first = fit_in_stages(whole(shooting), nominal, free)
    else:
        first = fit(whole(shooting), begun.values, free, begun.states, iterations=8)
    shooting = with_noise(shooting, corrected_noise(shooting, first, filtered_channels(observations)))
    problem = whole(shooting)
    fitted = fit(problem, first.values, free, first.states, iterations=8)
    at_nominal_values = fit(problem, nominal, (), fitted.states, iterations=5)
    rate = min(sum(len(channel.values) for channel in seen.measured) / seen.duration for seen in observations)
    lengths = [max(length, SAMPLES_A_WINDOW / rate) for length in SHORT]
    shorter = tuple(cut_together(observations, nominal, STEPS[0], length, model.per_recording) for length in lengths)
    return Calibration(shooting, problem, at_nominal_values, fitted, shorter)


def step_needed(observations: Sequence[Observation], shooting: Shooting, model: Fit) -> float:
    """The longest of STEPS [s] at which halving it changes the response by less than any effect must gain to be named
    (for a model far from the noise, by less than the share WORTH of its excess chi^2), with the windows and noise of
    `shooting`."""
    noticed = max(ENOUGH, WORTH * (model.objective - model.count))
    for step_size in STEPS[:-1]:
        if step_error(observations, shooting, model, step_size) < noticed:
            return step_size
    return STEPS[-1]


def step_error(observations: Sequence[Observation], shooting: Shooting, model: Fit, step_size: float) -> float:
    """Chi^2 between a model's responses at a step size and at half of it, at their common samples."""
    noise = [sampling.noise for sampling in shooting.samplings]
    coarse, fine = (
        with_noise(cut_together(observations, model.values, size, per_recording=shooting.per_recording), noise)
        for size in (step_size, 0.5 * step_size)
    )
    responses = [cut.sample(cut.simulate(model.values, model.states)[0]) for cut in (coarse, fine)]
    total = 0.0
    for sampling, other, first, second in zip(coarse.samplings, fine.samplings, *responses, strict=True):
        stamps, others = np.round(1e9 * coarse.times(sampling)), np.round(1e9 * fine.times(other))
        _, here, there = np.intersect1d(stamps, others, return_indices=True)
        total += float(np.sum(((first[here] - second[there]) / sampling.noise) ** 2))
    return total


def at_step(observations: Sequence[Observation], calibration: Calibration, step_size: float) -> Calibration:
    """A calibration continued at another step size, with its noise levels."""
    before, given, fitted = calibration.shooting, calibration.nominal, calibration.fitted
    cut = cut_together(observations, given.values, step_size, per_recording=before.per_recording)
    shooting = with_noise(cut, [sampling.noise for sampling in before.samplings])
    problem = whole(shooting)
    again = fit(problem, fitted.values, fitted.free, fitted.states, iterations=8)
    nominal = fit(problem, given.values, (), again.states, iterations=5)
    return replace(calibration, shooting=shooting, problem=problem, nominal=nominal, fitted=again)


def calibrate_without_faulty_ends(
    observations: Sequence[Observation], model: NominalModel
) -> tuple[tuple[Observation, ...], Calibration]:
    """Calibrate, and once more without a recording's last window where only that departs from the model."""
    calibration = calibrate(observations, model)
    rest = tuple(
        _without_faulty_end(observation, calibration, number) for number, observation in enumerate(observations, 1)
    )
    if all(observation is other for observation, other in zip(rest, observations, strict=True)):
        return rest, calibration
    return rest, calibrate(rest, model, calibration.shooting.step_size)


def _without_faulty_end(observation: Observation, calibration: Calibration, number: int) -> Observation:
    """A recording without its last window, if the model's excess chi^2 is concentrated there."""
    shooting = recording_alone(calibration.shooting, number)
    share = _share_of_last_window(shooting, fit_alone(calibration.shooting, calibration.fitted, number))
    last = float(shooting.edges[-1] - shooting.edges[-2]) * shooting.step_size
    if share < NOWHERE_ELSE or observation.duration < SHORTEST + last:
        return observation
    why = f"{100 * share:.0f} % of the nominal model's unexplained error is there, as when nodes shut down"
    return without_end(observation, last, why)


def _share_of_last_window(shooting: Shooting, fitted: Fit) -> float:
    """The last window's share of the fit's excess chi^2; 0 where that is negligible."""
    if shooting.windows < 3:
        return 0.0
    before = at_the_end = 0.0
    for sampling, residual in zip(shooting.samplings, fitted.residuals, strict=True):
        square, last = residual**2, sampling.window == shooting.windows - 1
        before += max(0.0, float(np.sum(square[~last] - 1.0)))
        at_the_end += float(np.sum(square[last] - min(1.0, float(square[~last].mean()))))
    return at_the_end / (before + at_the_end) if at_the_end > AT_ALL else 0.0


def filtered_channels(observations: Sequence[Observation]) -> frozenset[str]:
    """The channels behind a low-pass filter, by their names in a fit."""
    return frozenset(
        named(fault.channel, number)
        for number, observation in enumerate(observations, 1)
        for fault in observation.health
        if fault.fault == "low_passed"
    )


def is_at_noise(result: Fit) -> bool:
    """Whether a fit leaves no more than noise."""
    return result.data < NEAR_NOISE * result.count


def corrected_noise(shooting: Shooting, result: Fit, filtered: Collection[str] = ()) -> list[float]:
    """Each channel's noise level from the residual's second differences, within a factor of two of the channel's own.

    Behind a low-pass filter the differences show little of the noise, and neighbouring samples are correlated, so that
    as many of them carry less information. There it is the noise before the filter, up to BEHIND_A_FILTER times that
    of the differences.
    """
    found = []
    for name, sampling, residual in zip(shooting.names, shooting.samplings, result.residuals, strict=True):
        own = sampling.own_noise
        level = np.clip(sampling.noise * residual_noise(residual), 0.5 * own, 2.0 * own)
        if name in filtered:
            before = sampling.noise * float(np.sqrt(np.mean(residual**2) * colour_of(residual).slow))
            level = np.clip(before, level, BEHIND_A_FILTER * level)
        found.append(max(float(level), RESOLVED["Pa" if sampling.column > 1 else "m"]))
    return found


def identifiable(result: Fit, name: str) -> bool:
    """Whether the fit's standard deviation of a parameter is below half that of its prior."""
    place = [parameter.name for parameter in result.free].index(name)
    return bool(np.sqrt(max(result.covariance[place, place], 0.0)) < 0.5 * result.free[place].prior_deviation)


def has_changed(result: Fit, nominal: Mapping[str, float], name: str) -> bool:
    """Whether a fitted parameter differs from its nominal value significantly and by a relevant amount."""
    place = [parameter.name for parameter in result.free].index(name)
    parameter = result.free[place]
    given = nominal[base_name(name)]
    departure = abs(result.values[name] - given)
    relevant = RELEVANT * (abs(given) if parameter.logarithmic else max(abs(given), parameter.scale))
    return departure > NOTICEABLE * result.deviation(name) and departure > relevant
