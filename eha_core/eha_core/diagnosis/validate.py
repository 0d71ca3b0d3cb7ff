"""Judge a model on parts of the recording that it was not fitted to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.fit import Fit, fit, refit_states
from eha_core.diagnosis.numbers import Array
from eha_core.diagnosis.problem import Problem
from eha_core.diagnosis.shooting import Shooting, held_out


@dataclass(frozen=True)
class Judged:
    """A model fitted on two thirds of the windows: chi^2 on the rest, and each channel's RMSE [its unit] on both
    parts."""

    chi_square: float
    count: int
    training: Mapping[str, float]
    held_out: Mapping[str, float]


def split(shooting: Shooting) -> tuple[Problem, Problem]:
    """The windows to fit on, and those to judge on. Two windows or fewer are both."""
    judged = np.array(list(held_out(shooting.windows)), dtype=np.int64)
    rest = np.setdiff1d(np.arange(shooting.windows), judged)
    if shooting.windows < 3:
        everything = np.arange(shooting.windows)
        return Problem(shooting, everything), Problem(shooting, everything)
    return Problem(shooting, rest), Problem(shooting, judged)


def judge(shooting: Shooting, model: Fit, refit: bool = True) -> Judged:
    """Refit `model` on the training windows only, then fit the judged windows' starts with its parameters held."""
    training, judged = split(shooting)
    fitted = (
        fit(training, model.values, model.free, model.states, iterations=6) if refit else refit_states(training, model)
    )
    outside = refit_states(judged, fitted)
    return Judged(
        outside.data, outside.count, channel_rmse(training, fitted.residuals), channel_rmse(judged, outside.residuals)
    )


def channel_rmse(problem: Problem, residuals: tuple[Array, ...]) -> dict[str, float]:
    """RMSE of each channel over the problem's windows, in the channel's unit."""
    used = problem.used()
    found = {}
    for name, one, residual in zip(problem.shooting.names, problem.shooting.samplings, residuals, strict=True):
        part = residual[used[one.window]]
        found[name] = float(np.sqrt(np.mean(part**2)) * one.noise) if len(part) else float("nan")
    return found
