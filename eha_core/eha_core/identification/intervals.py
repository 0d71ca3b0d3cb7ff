"""Standard deviations that account for a residual that is not white noise.

The curvature at the optimum is right if the residual is white noise. A law of slightly wrong form causes a residual
that is coherent over an interval and biases parameters. Therefore the variance is also estimated from the residual, by
summing each parameter's pull over blocks of time (a sandwich estimator: P. J. Huber, 1967; K.-Y. Liang and S. L. Zeger,
Biometrika 73, 1986). For coloured noise there is a third estimate, from the residual's autocorrelation, which covers
time constants longer than a block. The largest of the three counts.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eha_core.identification.colour import colour_of, spread
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.problem import Linearised, Problem, linearise, normal_equations
from eha_core.identification.shooting import STATE_SIZE

BLOCK = 0.1
"""s; a residual counts as independent over longer times. Transients of friction and of the oil are shorter."""


def with_residual(problem: Problem, result: Fit) -> Fit:
    """The fit with its parameters' standard deviations at its end, widened where the residual is not white."""
    if not result.free:
        return result
    white, wider = at_its_end(problem, result)
    every = np.concatenate([wider, np.ones(len(white.covariance) - len(wider))])
    return replace(white, covariance=white.covariance * np.outer(every, wider))


def at_its_end(problem: Problem, result: Fit) -> tuple[Fit, Array]:
    """The fit with the covariance from the curvature at its end, for its own is that of the iteration before; and how
    many times as wide each parameter's standard deviation is because the residual is not white (parameters,)."""
    count = len(result.free)
    linear = linearise(problem, result.values, result.free, result.q, result.states)
    normal, _ = normal_equations(problem, result.free, result.q, result.states, linear)
    white = replace(result, covariance=normal.covariance())
    design = _pulls(problem, white, linear)
    pulls = design * linear.residual[:, None]
    blocks = (problem.flat_times() / BLOCK).astype(np.int64)
    used, place = np.unique(blocks, return_inverse=True)
    summed = np.zeros((len(used), count))
    np.add.at(summed, place, pulls)
    observed = np.sqrt(np.sum(summed**2, axis=0) * len(used) / max(len(used) - 1, 1))
    observed = np.maximum(observed, np.sqrt(_by_colour(problem, design, linear.residual)))
    expected = np.sqrt(np.maximum(np.diag(white.covariance)[:count], 1e-300))
    return white, np.maximum(1.0, observed / expected)


def _pulls(problem: Problem, result: Fit, linear: Linearised) -> Array:
    """The shift of each parameter's coordinate for a residual of one: (samples, parameters), sorted by window."""
    count, size = len(result.free), problem.shooting.free_states
    pulls = linear.by_parameter @ result.covariance[:count]
    bounds = np.searchsorted(linear.window, np.arange(problem.shooting.windows + 1))
    for window in range(problem.shooting.windows):
        own = slice(bounds[window], bounds[window + 1])
        place = count + STATE_SIZE * window + np.arange(size)
        pulls[own] += linear.by_state[own] @ result.covariance[place]
    return np.asarray(pulls)


def _by_colour(problem: Problem, design: Array, residual: Array) -> Array:
    """Variance of each parameter's coordinate if each channel's noise has the colour and size of its residual."""
    variance = np.zeros(design.shape[1])
    for places in problem.places:
        own = residual[places]
        if len(own):
            variance += float(np.mean(own**2)) * spread(design[places], colour_of(own))
    return variance
