"""A 95 % interval from chi^2 itself where that is not a parabola: friction that holds a piston has no upper limit.

The value is held at one place after the other while all others are refitted; the interval ends where chi^2 rises by
more than chance (profile likelihood: D. J. Venzon, S. H. Moolgavkar, Applied Statistics 37, 1988).
"""

from __future__ import annotations

from collections.abc import Callable

from eha_core.identification.fit import Fit, fit
from eha_core.identification.problem import Problem

ADAPTS = 6
"""Iterations of each refit: the optimum moves little from one place to the next."""
HALVINGS = 5
"""Bisections between the fitted and the neutral value: the end is found to a thirtieth of the distance."""
FARTHER = (2.0, 4.0, 16.0)
"""Multiples of the distance from the neutral value that are tried before the interval counts as open."""

Ends = tuple[float | None, float | None]


def profile_interval(problem: Problem, result: Fit, name: str, nothing: float, cost: float) -> Ends:
    """The ends of the interval in which chi^2 stays within `cost` of the fit's; None for an open end.

    `nothing`: the parameter's neutral value.
    """
    at = result.values[name]
    (moved,) = (parameter for parameter in result.free if parameter.name == name)

    def is_inside(share: float) -> bool:
        value = min(max(nothing + share * (at - nothing), moved.lower), moved.upper)
        others = tuple(parameter for parameter in result.free if parameter.name != name)
        found = fit(problem, {**result.values, name: value}, others, result.states, iterations=ADAPTS)
        return found.objective <= result.objective + cost

    inner, outer = _inner(is_inside), _outer(is_inside)
    ends = tuple(None if share is None else nothing + share * (at - nothing) for share in (inner, outer))
    return (ends[0], ends[1]) if at >= nothing else (ends[1], ends[0])


def _inner(is_inside: Callable[[float], bool]) -> float | None:
    """The end towards the neutral value, as a share of the distance; None where the neutral value is inside."""
    if is_inside(0.0):
        return None
    outside, inside = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (outside + inside)
        outside, inside = (outside, middle) if is_inside(middle) else (middle, inside)
    return inside


def _outer(is_inside: Callable[[float], bool]) -> float | None:
    """The end away from the neutral value; None where it is open."""
    inside = 1.0
    for times in FARTHER:
        if not is_inside(times):
            return float((inside * times) ** 0.5)
        inside = times
    return None
