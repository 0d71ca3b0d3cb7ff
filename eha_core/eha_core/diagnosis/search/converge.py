"""The leaders fitted until they converge, from more than one start.

A fit that stops short of its optimum makes its rivals look better than they are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eha_core.diagnosis.criteria import NEAR_NOISE
from eha_core.diagnosis.search.found import CONVERGE_WITHIN, Found, Progress, best_first
from eha_core.diagnosis.search.nominal_start import is_improbable, nominal_values_of, with_dynamics_held
from eha_core.identification.fit import Fit, fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.problem import Problem

CONVERGED_LEADERS = 3

INSTANT_REACHES = (2.4, 1.2, 0.6, 0.3)
"""s; how far off an instant may be found to be before the rest is fitted to it again."""

INSTANT_SHIFTS = (-0.12, 0.12, -0.04, 0.04, -0.01, 0.01, -0.004, 0.004, -0.0015, 0.0015)
"""s; how far beside its optimum an instant is tried once more."""


def converge(problem: Problem, found: Found, progress: Progress = lambda _: None) -> Found:
    """The leaders fitted until they converge, with derivatives at the full step.

    Where more than noise is left, or a nominal parameter went improbably far, they are fitted from the nominal values,
    too: beginning at a calibration that is far off, the nominal parameters can end in a local minimum. When an effect
    acts is looked for once: `warm_start` gives what the first one's interval is to the others.
    """
    exact = replace(problem, slope_step=problem.shooting.step_size)
    best = np.inf
    converged = dict(found)
    leaders = best_first(found)[:CONVERGED_LEADERS]
    for hypothesis in leaders:
        result = found[hypothesis]
        if not comes_near(problem, result, best):
            continue
        progress(f"fitting {' and '.join(hypothesis.ids)}")
        result = fit(exact, result.values, result.free, result.states, iterations=30)
        if result.data > NEAR_NOISE * result.count or is_improbable(result):
            again = fit(problem, {**result.values, **nominal_values_of(result.free)}, result.free, None, iterations=15)
            if again.objective < result.objective:
                result = fit(exact, again.values, again.free, again.states, iterations=6)
        dynamics_held = with_dynamics_held(problem, result)
        if dynamics_held is not None:
            again = fit(problem, dynamics_held.values, result.free, dynamics_held.states, iterations=10)
            if again.objective < result.objective:
                result = fit(exact, again.values, again.free, again.states, iterations=6)
        if result.objective < best or not (hypothesis.has_one_interval and leaders[0].has_one_interval):
            result = _other_instants(problem, exact, result)
        best = min(best, result.objective)
        converged[hypothesis] = result
    return converged


def comes_near(problem: Problem, result: Fit, best: float) -> bool:
    """Whether a fit lies near enough to the best objective that it may come to lead when both have converged."""
    return result.objective <= best + 0.5 * max(best - problem.count(), 0.0) + CONVERGE_WITHIN


def _other_instants(problem: Problem, exact: Problem, result: Fit) -> Fit:
    """An instant that a fit moves can rest beside the right one, by far or by a little: try its surroundings."""
    for parameter in result.free:
        if parameter.resolution == 0.0:
            continue
        if result.data > NEAR_NOISE * result.count:
            result = _far_instant(problem, exact, result, parameter)
        for shift in INSTANT_SHIFTS:
            moved = {**result.values, parameter.name: result.values[parameter.name] + shift}
            again = fit(problem, moved, result.free, result.states, iterations=6, give_up_above=result.objective)
            if again.objective < result.objective:
                result = fit(exact, again.values, again.free, again.states, iterations=6)
    return result


def _far_instant(problem: Problem, exact: Problem, result: Fit, parameter: FreeParameter) -> Fit:
    """The instant looked for far and wide with all else as it stands: between a wrong one and the right one the windows
    alone are wrong."""
    best, at = result.objective, result.values[parameter.name]
    there = at
    for reach in INSTANT_REACHES:
        for instant in (there - reach, there + reach):
            moved = {**result.values, parameter.name: min(max(instant, parameter.lower), parameter.upper)}
            again = fit(problem, moved, (), result.states, iterations=3)
            if again.objective < best:
                best, at = again.objective, moved[parameter.name]
        there = at
    if best == result.objective:
        return result
    moved = {**result.values, parameter.name: at}
    found = fit(exact, moved, result.free, result.states, iterations=12)
    return found if found.objective < result.objective else result
