"""The paper's experiment: one sine of voltage, open loop, at four levels of internal leakage and without it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from eha_core.paper.level import Array, Level, Sweep, closed_form, measure, root_mean_square
from eha_core.paper.printed import LEVELS
from eha_core.plant import Plant
from eha_core.signals.sine import Sine


@dataclass(frozen=True)
class Experiment:
    """The conditions, those that the paper leaves open included; see `eha_core.paper.LEFT_OPEN`.

    `parameters` are changes to the nominal plant. Every `keep`-th step of `step_size` [s] enters the figures.
    """

    command: Sine = field(default_factory=lambda: Sine(amplitude=8.4e-3, frequency=1.0))
    duration: float = 10.0
    step_size: float = 1e-4
    keep: int = 10
    parameters: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Reproduction:
    """The four levels of Tables 2 and 3, and RMSE over leakage between and around them."""

    experiment: Experiment
    levels: tuple[Level, ...]
    sweep: Sweep


def reproduce(experiment: Experiment | None = None) -> Reproduction:
    """Carry out the experiment."""
    experiment = experiment or Experiment()
    time, reference = _displacement(experiment, 0.0)
    levels = tuple(
        measure(leakage, time, _displacement(experiment, leakage)[1], reference, experiment.parameters)
        for leakage in LEVELS
    )
    return Reproduction(experiment, levels, _sweep(experiment, reference))


def _displacement(experiment: Experiment, internal_leakage: float) -> tuple[Array, Array]:
    """Return time [s] and displacement [m] under one leakage coefficient."""
    plant = Plant({**experiment.parameters, "internal_leakage": internal_leakage}, step_size=experiment.step_size)
    starts = experiment.step_size * np.arange(round(experiment.duration / experiment.step_size))
    trajectory = plant.run(np.asarray(experiment.command.value(starts)), every=experiment.keep)
    return trajectory.time, trajectory.position


def _sweep(experiment: Experiment, reference: Array) -> Sweep:
    leakages = np.logspace(-12.5, -8.5, 25).astype(np.float64)
    rmse = [root_mean_square(_displacement(experiment, leakage)[1] - reference) for leakage in leakages]
    reference_rms = root_mean_square(reference)
    predicted = [closed_form(leakage, reference_rms, experiment.parameters) for leakage in leakages]
    return Sweep(leakages, np.array(rmse), np.array(predicted))
