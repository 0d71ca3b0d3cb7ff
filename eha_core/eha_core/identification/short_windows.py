"""Short windows: where the search begins.

A window begins at a state of its own, and over a short one hardly anything can go another way than measured: whether
the piston sticks is told by the measurement, and the channels are nearly linear in all that is missing. Over a second a
break-away that comes late moves all that follows, and the objective has as many valleys as there are break-aways.
Multiple shooting with windows that grow is an old remedy (H. G. Bock, Recent advances in parameter identification
techniques for O.D.E., 1983).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.problem import Problem

SHORT = (0.1, 0.25)
"""s; the windows' lengths, the shortest first."""

HELD = 0.2
"""Share of its prior deviation within which a nominal parameter is believed at first, over the shortest windows. Free
from the start it takes what the effects have not come to yet, and stays there (measured on development cases)."""

FINER = 2e-4
"""s; the step of the derivatives where friction sticks. Between longer ones a break-away is lost, and a fit comes to
rest on that (measured on development cases)."""


def held(free: Sequence[FreeParameter], values: Mapping[str, float]) -> tuple[FreeParameter, ...]:
    """What is free, the plant's own parameters believed more (HELD) where they have their nominal values."""
    return tuple(
        replace(parameter, prior_deviation=HELD * parameter.prior_deviation)
        if "." not in parameter.name and values.get(parameter.name, parameter.reference) == parameter.reference
        else parameter
        for parameter in free
    )


def with_finer_slopes(problem: Problem) -> Problem:
    """The same problem with derivatives taken at FINER, or at its own step where that is longer."""
    return replace(problem, slope_step=max(FINER, problem.shooting.step_size))
