"""The gain that the search requires of an effect, and the response that reaches it with a given probability."""

from __future__ import annotations

from functools import lru_cache

from eha_core.diagnosis.criteria import CERTAINTY, ENOUGH, parameter_cost


def required_gain(of_a_member: float, parameters: int, count: int, variance: float = 1.0) -> float:
    """Chi^2 that one more effect with this number of parameters must gain in `count` samples to be named.

    It must reach the gain required of a member, and a sufficient score, which includes the cost of its parameters.
    `variance`: of the residual, in units of the noise's.
    """
    return max(of_a_member, variance * (ENOUGH + parameters * parameter_cost(count, variance)))


@lru_cache(maxsize=256)
def energy_needed(gain: float, parameters: int, power: float = CERTAINTY) -> float:
    """Chi^2 of an effect's noise-free response for a gain above `gain` with probability `power`.

    The gain of a fit is noncentral chi-squared with `parameters` degrees of freedom; the response's chi^2 is its
    noncentrality.
    """
    from scipy.optimize import brentq
    from scipy.special import chndtr

    # the mean gain is the energy plus one a parameter, its deviation twice the root: far beyond both ends lie these
    highest = 4.0 * gain + 100.0
    return float(brentq(lambda energy: chndtr(gain, parameters, energy) - (1.0 - power), 0.0, highest))


def probability_of(energy: float, gain: float, parameters: int) -> float:
    """Probability that an effect whose response has the chi^2 `energy` gains more than `gain`."""
    from scipy.special import chndtr

    return float(1.0 - chndtr(gain, parameters, energy))
