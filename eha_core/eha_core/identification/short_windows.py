"""Short windows, in which a response is nearly linear in what a model is missing.

Each window has its own initial state, so that a short simulation stays close to the measurement: it determines whether
the piston sticks, and the objective is smooth. Over a second, a late break-away shifts all that follows, and the
objective has a local minimum for each break-away. Multiple shooting with growing windows is an old remedy (H. G. Bock,
Recent advances in parameter identification techniques for O.D.E., 1983).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.problem import Problem

SHORT = (0.03, 0.2)
"""s; lengths of the windows in which sets are searched before the long ones. The shorter they are, the more linear the
response is: from the nominal values of a development rig with six effects, their sizes were predicted to 4 to 50 % over
20 ms and to factors of 3 over 100 ms."""

HELD = 0.2
"""Factor on the prior standard deviation of a nominal parameter over short windows. Free from the start, it compensates
for effects that have not converged yet, and stays there: of the true sets of ten development rigs, two then converged
above the noise; with this, all but one, which had play in a sensor, reached the noise."""

FINER = 2e-4
"""s; step size of the derivatives where friction may stick. Longer steps miss a break-away, at which a fit then stops:
presliding friction with four more effects at 25,700 times the noise's energy with 0.5 ms, at 1.01 times with this."""


def held(free: Sequence[FreeParameter], values: Mapping[str, float]) -> tuple[FreeParameter, ...]:
    """The free parameters, with a narrower prior (HELD) for those of the plant that have their nominal values."""
    return tuple(
        replace(parameter, prior_deviation=HELD * parameter.prior_deviation)
        if "." not in parameter.name and values.get(parameter.name, parameter.reference) == parameter.reference
        else parameter
        for parameter in free
    )


def with_finer_slopes(problem: Problem) -> Problem:
    """The same problem with derivatives taken at FINER, or at its own step where that is longer."""
    return replace(problem, slope_step=max(FINER, problem.shooting.step_size))
