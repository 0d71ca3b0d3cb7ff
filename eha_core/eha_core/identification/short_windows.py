"""Short windows, in which a response hardly bends with what a model leaves out.

A window begins at a state of its own, and over a short one hardly anything can go another way than measured: whether
the piston sticks is given by the measurement, and the objective is smooth. Over a second a break-away that comes late
moves all that follows, and the objective has as many valleys as there are break-aways. Multiple shooting with windows
that grow is an old remedy (H. G. Bock, Recent advances in parameter identification techniques for O.D.E., 1983).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.problem import Problem

SHORT = (0.03, 0.2)
"""s; the lengths of the windows in which sets are searched before the long ones. The shorter they are, the less a
response bends with what is missing: seen from the nominal values of a development rig of six effects, they were
predicted to 4 to 50 % of their sizes over 20 ms and to factors of 3 over 100 ms."""

HELD = 0.2
"""Share of its prior deviation within which a nominal parameter is believed over short windows. Free from the start it
takes what the effects have not come to yet, and stays there: of the true sets of ten development rigs two came to rest
above the noise so, and held all but one that had play in a sensor came to it."""

FINER = 2e-4
"""s; the step of the derivatives where friction may stick. Between longer ones a break-away is lost, and a fit comes to
rest on that: presliding friction beside four more effects at 25,700 times the noise's energy with 0.5 ms, at 1.01 times
with this."""


def held(free: Sequence[FreeParameter], values: Mapping[str, float]) -> tuple[FreeParameter, ...]:
    """What is free, the plant's own parameters believed more (HELD) where they have their nominal values."""
    return tuple(
        replace(parameter, prior_deviation=HELD * parameter.prior_deviation)
        if "." not in parameter.name
        and values.get(parameter.name, parameter.reference) == parameter.reference
        else parameter
        for parameter in free
    )


def with_finer_slopes(problem: Problem) -> Problem:
    """The same problem with derivatives taken at FINER, or at its own step where that is longer."""
    return replace(problem, slope_step=max(FINER, problem.shooting.step_size))
