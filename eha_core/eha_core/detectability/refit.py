"""Whether the linearisation's smallest size suffices: the nominal equations are fitted to its noise-free response.

Nominal parameters that nearly compensate for a response may compensate for it better when they move far.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite

from eha_core.detectability.planned import RigAsModelled
from eha_core.diagnosis.detection.responses import COMPENSATED, responses
from eha_core.diagnosis.detection.sizes import Trial
from eha_core.diagnosis.search.columns import Column
from eha_core.identification.fit import exact, fit

ITERATIONS = 8
"""Most iterations of such a fit; most fits end after two, and an unfinished one only has a larger residual."""

ROUNDS = 3
"""Most enlargements of a size."""

SHORT = 0.9
"""Share of the required energy below which a size is enlarged: 5 per cent of the size."""

LARGER = 3.0
"""Largest factor of one enlargement."""


def left_by_nominal(at: RigAsModelled, column: Column, thorough: bool = False) -> float:
    """Chi^2 of the best fit of the nominal equations to the test of a rig with a column's effect; `thorough`: with
    derivatives at the simulation's own step size, without which a fit may end early in a flat valley."""
    rig = at.with_effect(column)
    problem = exact(rig.pool.problem) if thorough else rig.pool.problem
    return fit(problem, at.fit.values, at.pool.plant, rig.fit.states, iterations=ITERATIONS, in_a_row=2).objective


def confirmed(at: RigAsModelled, tried: Sequence[Trial], factors: Sequence[float]) -> list[float]:
    """The factors, enlarged where the nominal equations explain the response better than the linearisation predicts;
    inf where that exceeds the catalogue's bound. None is reduced."""
    columns = [trial.at(factor if isfinite(factor) else 1.0) for trial, factor in zip(tried, factors, strict=True)]
    seen = responses(at, columns)
    return [_confirmed(at, trial, factor, seen.share(place) < COMPENSATED)
            for place, (trial, factor) in enumerate(zip(tried, factors, strict=True))]  # fmt: skip


def _confirmed(at: RigAsModelled, trial: Trial, factor: float, thorough: bool) -> float:
    for _ in range(ROUNDS):
        if not isfinite(factor):
            break
        left = left_by_nominal(at, trial.at(factor), thorough)
        if left >= SHORT * trial.energy:
            break
        if factor >= trial.most:
            return inf
        larger = min((trial.energy / max(left, 1e-12)) ** 0.5, LARGER)
        factor = min(factor * larger, trial.most)
    return factor
