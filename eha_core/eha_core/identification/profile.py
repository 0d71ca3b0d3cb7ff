"""A 95 % interval from the data's own chi^2, where it is no parabola: friction that holds a piston may be any larger.

The value is held at one place after the other while all else adapts; the interval ends where that costs more than
chance (profile likelihood: D. J. Venzon, S. H. Moolgavkar, Applied Statistics 37, 1988).
"""

from __future__ import annotations

from collections.abc import Callable

from eha_core.identification.fit import Fit, fit
from eha_core.identification.problem import Problem

ADAPTS = 6
"""Iterations of what adapts: from one place to the next it has not far to go."""
HALVINGS = 5
"""Of the way to where the value would explain nothing: the end is found to a thirtieth of it."""
FARTHER = (2.0, 4.0, 16.0)
"""Times the value's distance from nothing at which more is tried, before there is held to be no upper end."""

Ends = tuple[float | None, float | None]


def profile_interval(problem: Problem, result: Fit, name: str, nothing: float, cost: float) -> Ends:
    """The ends between which chi^2 stays within `cost` of the fit's; None where there is none.

    `nothing`: the parameter's value at which it explains nothing.
    """
    at = result.values[name]
    (moved,) = (parameter for parameter in result.free if parameter.name == name)

    def is_inside(share: float) -> bool:
        value = min(max(nothing + share * (at - nothing), moved.lower), moved.upper)
        others = tuple(parameter for parameter in result.free if parameter.name != name)
        limit = result.objective + cost
        found = fit(
            problem, {**result.values, name: value}, others, result.states, iterations=ADAPTS, give_up_above=limit
        )
        return found.objective <= limit

    inner, outer = _inner(is_inside), _outer(is_inside)
    ends = tuple(None if share is None else nothing + share * (at - nothing) for share in (inner, outer))
    return (ends[0], ends[1]) if at >= nothing else (ends[1], ends[0])


def _inner(is_inside: Callable[[float], bool]) -> float | None:
    """The end towards nothing, as a share of the value; None where nothing is inside."""
    if is_inside(0.0):
        return None
    outside, inside = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (outside + inside)
        outside, inside = (outside, middle) if is_inside(middle) else (middle, inside)
    return inside


def _outer(is_inside: Callable[[float], bool]) -> float | None:
    """The end away from nothing; None where there is none."""
    inside = 1.0
    for times in FARTHER:
        if not is_inside(times):
            return float((inside * times) ** 0.5)
        inside = times
    return None
