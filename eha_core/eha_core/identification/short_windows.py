"""A way to the optimum where friction sticks: from short windows to long ones.

A window begins at a state of its own, and over a short one hardly anything can go another way than measured: whether
the piston sticks is given by the measurement, and the objective is smooth. Over a second a break-away that comes late
moves all that follows, and the objective has as many valleys as there are break-aways. Multiple shooting with windows
that grow is an old remedy (H. G. Bock, Recent advances in parameter identification techniques for O.D.E., 1983).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eha_core.identification.fit import Fit, fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.numbers import Array
from eha_core.identification.problem import Problem, whole
from eha_core.identification.shooting import Shooting

SHORT = (0.1, 0.25)
"""s; the windows' lengths, the shortest first."""

VERY_SHORT = (0.03, 0.2)
"""s; where sets are searched. The shorter the windows, the less a response bends with what is missing: seen from the
nominal values of a development rig of six effects, they were predicted to 4 to 50 % of their sizes over 20 ms and to
factors of 3 over 100 ms."""

HELD = 0.2
"""Share of its prior deviation within which a nominal parameter is believed at first, over the shortest windows. Free
from the start it takes what the effects have not come to yet, and stays there. The true sets of ten development rigs of
seed 61331 came to the noise so, but for one with play in a sensor; free from the start, that of rig-0015 rested at 3.2
times its energy and that of rig-0010 at 1.02."""

ITERATIONS = 30

IN_A_ROW = 2
"""So many iterations that gain too little end such a fit. Where friction sticks, one may lead along a ridge: of the
true sets of four development rigs of seed 61331, two rested above the noise where one was enough (at 1.5 and 1.1 times
its energy, and with this at 1.1 and 0.8)."""

FINER = 2e-4
"""s; the step of the derivatives. Between longer ones a break-away is lost, and a fit comes to rest on that: presliding
friction beside four more effects (development case rig-0019 of seed 61331) at 25,700 times the noise's energy with
0.5 ms, at 1.01 times with this."""

OF_STATES = 8
"""Iterations of the windows' starts alone, before anything else may move: a speed that is measured badly would lead the
friction astray, which was right in the windows before."""


def from_short_windows(
    problem: Problem, shorter: Sequence[Shooting], values: Mapping[str, float], free: Sequence[FreeParameter]
) -> Fit:
    """Fit `free` from `values` over `shorter`, the same recordings cut as SHORT says, and then over `problem`.

    `shorter` has the noise that the channels show by themselves: what a model far off leaves seems to be noisier, and
    beside that the links would weigh too much.
    """
    return to_long_windows(problem, shorter, over_the_shortest(shorter, values, free).values, free)


def over_the_shortest(shorter: Sequence[Shooting], values: Mapping[str, float], free: Sequence[FreeParameter]) -> Fit:
    """The effects fitted alone over the shortest windows, then with the plant's own parameters held, and then free."""
    short = whole(shorter[0])
    alone = _from_its_starts(short, values, [parameter for parameter in free if is_of_an_effect(parameter)])
    return _from_its_starts(short, _from_its_starts(short, alone.values, held(free, values)).values, free)


def to_long_windows(
    problem: Problem, shorter: Sequence[Shooting], values: Mapping[str, float], free: Sequence[FreeParameter]
) -> Fit:
    """Fit `free` from where the shortest windows led, over the longer ones."""
    for part in map(whole, shorter[1:]):
        values = _from_its_starts(part, values, free).values
    return _from_its_starts(problem, values, free)


def _from_its_starts(problem: Problem, values: Mapping[str, float], free: Sequence[FreeParameter]) -> Fit:
    begun = starts(problem, values)
    return fit(with_finer_slopes(problem), values, free, begun, iterations=ITERATIONS, in_a_row=IN_A_ROW)


def held(free: Sequence[FreeParameter], values: Mapping[str, float]) -> tuple[FreeParameter, ...]:
    """What is free, the plant's own parameters believed more (HELD) where they have their nominal values."""
    return tuple(
        replace(parameter, prior_deviation=HELD * parameter.prior_deviation)
        if not is_of_an_effect(parameter) and values.get(parameter.name, parameter.reference) == parameter.reference
        else parameter
        for parameter in free
    )


def is_of_an_effect(parameter: FreeParameter) -> bool:
    """Whether a parameter is an effect's, and not the plant's own."""
    return "." in parameter.name


def with_finer_slopes(problem: Problem) -> Problem:
    """The same problem with derivatives taken at FINER, or at its own step where that is longer."""
    return replace(problem, slope_step=max(FINER, problem.shooting.step_size))


def starts(problem: Problem, values: Mapping[str, float]) -> Array:
    """The windows' starts fitted to such values."""
    return fit(problem, values, (), iterations=OF_STATES).states
