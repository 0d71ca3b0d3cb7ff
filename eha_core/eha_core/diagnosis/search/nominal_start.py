"""A fit taken back to nominal values, from where it can be fitted again without what biased them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from eha_core.identification.fit import Fit, fit
from eha_core.identification.free_parameters import LATE, FreeParameter, coordinates
from eha_core.identification.per_recording import is_one_of
from eha_core.identification.problem import Problem
from eha_core.parameters import NOMINAL

BIASED = 0.02
"""Share by which a calibration must have moved the valve's dynamics for a delay or a lag to be what it imitated."""

TRIED_WITH_DYNAMICS_HELD = 2
HELD_SHARE = 0.25
"""So many effects are tried with the valve's dynamics held, if their predicted gain is this share of what others need:
a linear prediction says less where the dynamics have to come back first (assumed)."""

IMPROBABLE = 2.0
"""Prior standard deviations by which a nominal parameter must have moved for a fit to be suspected of a local minimum.
Assumed; nominal values that are off by 30 % are off by 1.2 of them at most."""

NOMINAL_NAMES = frozenset(row.name for row in NOMINAL)


def nominal_values_of(free: Iterable[FreeParameter]) -> dict[str, float]:
    """The nominal values of those that are nominal parameters."""
    return {parameter.name: parameter.reference for parameter in free if is_one_of(parameter.name, NOMINAL_NAMES)}


def with_dynamics_held(problem: Problem, calibrated: Fit) -> Fit | None:
    """The calibration with the valve's dynamics at their nominal values; None where it hardly moved them."""
    late = {parameter.name: parameter.reference for parameter in calibrated.free if is_one_of(parameter.name, LATE)}
    if all(abs(calibrated.values[name] / given - 1.0) < BIASED for name, given in late.items()):
        return None
    rest = [parameter for parameter in calibrated.free if parameter.name not in late]
    held = fit(problem, {**calibrated.values, **late}, rest, calibrated.states, iterations=5)
    return set_free(held, calibrated.free)


def at_nominal_values(problem: Problem, calibrated: Fit) -> Fit:
    """The calibration with every nominal parameter back at its nominal value, only the windows' starts fitted again."""
    values = {**calibrated.values, **nominal_values_of(calibrated.free)}
    return set_free(fit(problem, values, (), calibrated.states, iterations=5), calibrated.free)


def is_improbable(result: Fit) -> bool:
    """Whether a fit took a nominal parameter further from its nominal value than that is likely to be off."""
    return any(
        abs(float(at)) > IMPROBABLE * parameter.prior_deviation
        for parameter, at in zip(result.free, result.q, strict=True)
        if is_one_of(parameter.name, NOMINAL_NAMES)
    )


def set_free(held: Fit, free: tuple[FreeParameter, ...]) -> Fit:
    """A fit as a point at which all of `free` may move again."""
    return replace(held, free=free, q=coordinates(free, held.values))
