"""A way to the optimum where friction sticks: from short windows to long ones.

A window begins at a state of its own, and over a short one hardly anything can go another way than measured: whether
the piston sticks is told by the measurement, and the objective is smooth. Over a second a break-away that comes late
moves all that follows, and the objective has as many valleys as there are break-aways. Multiple shooting with windows
that grow is an old remedy (H. G. Bock, Recent advances in parameter identification techniques for O.D.E., 1983).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eha_core.identification.fit import Fit, fit, fit_in_stages
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.numbers import Array
from eha_core.identification.problem import Problem, whole
from eha_core.identification.shooting import Shooting

SHORT = (0.05, 0.1, 0.25)
"""s; the windows' lengths, the shortest first."""

SLACK = (100.0, 1.0, 1.0)
"""How many times looser than LINK they hang together: the first hardly do. From starts of Stribeck's law with a
velocity as large as the speeds, of which long windows led none nearer than 14 times the noise's energy, these led all
to 2.5 times and less, and to the same forces within a tenth (development case other_law-0000 of seed 2026, another form
of the law)."""

ITERATIONS = 30

OF_STATES = 8
"""Iterations of the windows' starts alone, before anything else may move: a speed that is measured badly would lead the
friction astray, which was right in the windows before."""


FINER = 2e-4
"""s; the step of the derivatives with which such a fit ends. Between longer ones a break-away is lost, and a fit comes
to rest on that: at 1.41 times the noise's energy where this one goes on to the noise
(tests/diagnosis/test_set_with_friction.py)."""


def from_short_windows(
    problem: Problem, shorter: Sequence[Shooting], values: Mapping[str, float], free: Sequence[FreeParameter]
) -> Fit:
    """Fit `free` from `values` over `shorter`, the same recordings cut as SHORT says, and then over `problem`.

    `shorter` has the noise that the channels show by themselves: what a model far off leaves seems to be noisier, and
    beside that the links would weigh too much.
    """
    for place, (shooting, slack) in enumerate(zip(shorter, SLACK, strict=True)):
        part = replace(whole(shooting), slack=slack)
        run = fit if place else fit_in_stages
        values = run(part, values, free, starts(part, values), iterations=ITERATIONS).values
    found = fit(problem, values, free, starts(problem, values), iterations=ITERATIONS)
    return fit(with_finer_slopes(problem), found.values, found.free, found.states, iterations=ITERATIONS)


def with_finer_slopes(problem: Problem) -> Problem:
    """The same problem with derivatives taken at FINER, or at its own step where that is longer."""
    return replace(problem, slope_step=max(FINER, problem.shooting.step_size))


def starts(problem: Problem, values: Mapping[str, float]) -> Array:
    """The windows' starts fitted to such values."""
    return fit(problem, values, (), iterations=OF_STATES).states
