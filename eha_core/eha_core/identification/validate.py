"""Validation of a model on parts of the recording that it was not fitted to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from eha_core.identification.fit import Fit, fit, refit_states
from eha_core.identification.numbers import Array
from eha_core.identification.problem import Problem
from eha_core.identification.segments import held_out
from eha_core.identification.shooting import Shooting


@dataclass(frozen=True)
class Judged:
    """A model fitted on two thirds of the windows: chi^2 on the rest, and each channel's RMSE [its unit] on both
    parts."""

    chi_square: float
    count: int
    training: Mapping[str, float]
    held_out: Mapping[str, float]


def split(shooting: Shooting, instants: Sequence[float] = ()) -> tuple[Problem, Problem]:
    """The training windows and the held-out ones; two windows or fewer are both.

    A change at one of the `instants` [s, in every recording] can only be fitted there: their windows, and those before
    and after, are training windows. Between two instants with three or more windows, one is held out, too.
    """
    chosen = {window for windows in shooting.recordings for window in _judged_of(shooting, windows, instants)}
    judged = np.array(sorted(chosen), dtype=np.int64)
    rest = np.setdiff1d(np.arange(shooting.windows), judged)
    if shooting.windows < 3 or len(judged) == 0:
        everything = np.arange(shooting.windows)
        return Problem(shooting, everything), Problem(shooting, everything)
    return Problem(shooting, rest), Problem(shooting, judged)


def _judged_of(shooting: Shooting, windows: range, instants: Sequence[float]) -> set[int]:
    """The held-out windows of one recording."""
    ends = shooting.local_edges[windows.start : windows.stop, 1]
    inside = sorted(instant for instant in instants if instant < ends[-1])
    events = [windows.start + int(window) for window in np.searchsorted(ends[:-1], inside)]
    eventful = {window + beside for window in events for beside in (-1, 0, 1)}
    chosen = {windows[window] for window in held_out(len(windows))} - eventful
    for first, last in pairwise(events):
        between = range(first + 1, last)
        if len(between) >= 3 and chosen.isdisjoint(between):
            chosen.add(between[len(between) // 2])
    return chosen


def judge(shooting: Shooting, model: Fit, instants: Sequence[float] = ()) -> Judged:
    """Refit `model` on the training windows, then fit only the initial states of the held-out windows."""
    training, judged = split(shooting, instants)
    fitted = fit(training, model.values, model.free, model.states, iterations=6)
    outside = refit_states(judged, fitted)
    return Judged(
        outside.data, outside.count, channel_rmse(training, fitted.residuals), channel_rmse(judged, outside.residuals)
    )


def instants_of(model: Fit) -> list[float]:
    """The instants that are free parameters of a model [s]."""
    return [model.values[parameter.name] for parameter in model.free if parameter.resolution > 0.0]


def channel_rmse(problem: Problem, residuals: tuple[Array, ...]) -> dict[str, float]:
    """RMSE of each channel over the problem's windows, in the channel's unit."""
    used = problem.used()
    found = {}
    for name, sampling, residual in zip(problem.shooting.names, problem.shooting.samplings, residuals, strict=True):
        part = residual[used[sampling.window]]
        found[name] = float(np.sqrt(np.mean(part**2)) * sampling.noise) if len(part) else float("nan")
    return found
