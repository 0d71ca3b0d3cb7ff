"""Several recordings of one rig as one: fitted with one set of parameters and effects, each from its own states.

Their windows follow one another. At the first window of each, the states that run through the others begin again: coil,
spool, the effects' own states, and time. There is no continuity from one recording to the next.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from eha_core.errors import RecordingError
from eha_core.identification.fit import Fit
from eha_core.identification.observation import Observation
from eha_core.identification.per_recording import named, values_of
from eha_core.identification.segments import cut, rows_every
from eha_core.identification.shooting import Sampling, Shooting


def cut_together(
    observations: Sequence[Observation],
    values: Mapping[str, float],
    step_size: float = 2e-4,
    window: float = 1.0,
    per_recording: Sequence[str] = (),
) -> Shooting:
    """`cut` for all recordings: one record with the windows of all.

    The second recording's channels are named `position@2`, and so on. `per_recording`: parameters with a value in each.
    """
    every = int(np.gcd.reduce([rows_every(observation, step_size) for observation in observations]))
    each = [
        cut(observation, values_of(values, number), step_size, window, every)
        for number, observation in enumerate(observations, 1)
    ]
    return joined(each, per_recording)


def check_alike(observations: Sequence[Observation]) -> None:
    """Raise RecordingError unless all are driven by the same channels."""
    first = observations[0]
    for other in observations[1:]:
        if other.drive != first.drive:
            raise RecordingError(
                f"{other.path}: is driven by its {other.drive}, {first.path} by its {first.drive}; recordings of one"
                " rig need the same driving channel; diagnose each on its own with --each"
            )


def joined(each: Sequence[Shooting], per_recording: Sequence[str] = ()) -> Shooting:
    """Recordings cut at the same step and rows, one after another."""
    first = each[0]
    windows = np.cumsum([0, *(shooting.windows for shooting in each)])
    steps = np.cumsum([0, *(int(shooting.edges[-1]) for shooting in each)])
    samplings = [
        replace(sampling, row=sampling.row + begin // first.every, window=sampling.window + window)
        for shooting, begin, window in zip(each, steps, windows, strict=False)
        for sampling in shooting.samplings
    ]
    return replace(
        first,
        inputs=np.ascontiguousarray(np.concatenate([shooting.inputs for shooting in each], axis=1)),
        edges=np.concatenate(
            [[0], *(shooting.edges[1:] + begin for shooting, begin in zip(each, steps, strict=False))]
        ),
        leakage=np.concatenate([shooting.leakage for shooting in each]),
        samplings=tuple(samplings),
        names=tuple(named(name, number) for number, shooting in enumerate(each, 1) for name in shooting.names),
        initial_states=np.concatenate([shooting.initial_states for shooting in each]),
        first_windows=tuple(int(window) for window in windows[:-1]),
        per_recording=tuple(per_recording),
        restarts=tuple(
            int(window + first) for shooting, first in zip(each, windows, strict=False) for window in shooting.restarts
        ),
    )


def recording_alone(shooting: Shooting, number: int) -> Shooting:
    """One recording of several, counted from one, by itself."""
    if len(shooting.first_windows) == 1:
        return shooting
    windows = shooting.recordings[number - 1]
    begin, end = int(shooting.edges[windows.start]), int(shooting.edges[windows.stop])
    inside = [_belongs(sampling, windows) for sampling in shooting.samplings]
    names = [name for name, belongs in zip(shooting.names, inside, strict=True) if belongs]
    return replace(
        shooting,
        inputs=np.ascontiguousarray(shooting.inputs[:, begin:end]),
        edges=shooting.edges[windows.start : windows.stop + 1] - begin,
        leakage=shooting.leakage[windows.start : windows.stop],
        samplings=tuple(
            replace(sampling, row=sampling.row - begin // shooting.every, window=sampling.window - windows.start)
            for sampling, belongs in zip(shooting.samplings, inside, strict=True)
            if belongs
        ),
        names=tuple(name.partition("@")[0] for name in names),
        initial_states=shooting.initial_states[windows.start : windows.stop],
        first_windows=(0,),
        per_recording=(),
        restarts=tuple(window - windows.start for window in shooting.restarts if window in windows),
    )


def fit_alone(shooting: Shooting, result: Fit, number: int) -> Fit:
    """The part of a fit of several recordings that belongs to one of them."""
    if len(shooting.first_windows) == 1:
        return result
    windows = shooting.recordings[number - 1]
    inside = [_belongs(sampling, windows) for sampling in shooting.samplings]
    residuals = tuple(residual for residual, belongs in zip(result.residuals, inside, strict=True) if belongs)
    data = sum(float(np.sum(residual**2)) for residual in residuals)
    return replace(
        result,
        values=values_of(result.values, number),
        states=result.states[windows.start : windows.stop],
        residuals=residuals,
        data=data,
        objective=data,
        count=sum(len(residual) for residual in residuals),
    )


def _belongs(sampling: Sampling, windows: range) -> bool:
    return len(sampling.window) > 0 and int(sampling.window[0]) in windows
