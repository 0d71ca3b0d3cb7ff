"""Shapley's shares of a quantity that each subset of some players has a value of; the order that lowers it fastest.

A subset is a whole number whose bit k says that player k is in it; `values[subset]` is the quantity.

Source: L. S. Shapley, "A value for n-person games", Contributions to the Theory of Games II, Princeton 1953.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def players_of(values: Array) -> int:
    """How many players there are to (2^n,) values."""
    return len(values).bit_length() - 1


def shares(values: Array) -> Array:
    """Shares (n,) that add up to the whole set's value less the empty one's.

    A player's is what it adds, in the mean over all orders in which the players can come one after another.
    """
    count = players_of(values)
    subsets = np.arange(len(values))
    sizes = np.array([subset.bit_count() for subset in subsets.tolist()])
    weights = np.array([factorial(size) * factorial(count - size - 1) / factorial(count) for size in range(count)])
    found = np.empty(count)
    for player in range(count):
        without = subsets[subsets & (1 << player) == 0]
        found[player] = np.sum(weights[sizes[without]] * (values[without | (1 << player)] - values[without]))
    return found


def without_each(values: Array) -> Array:
    """The quantity (n,) when one player alone leaves the whole set."""
    whole = len(values) - 1
    return values[[whole & ~(1 << player) for player in range(players_of(values))]]


def fastest_removal(values: Array, removable: Sequence[int]) -> list[int]:
    """These players one after another out of the whole set, each time the one without which least is left."""
    subset, order, rest = len(values) - 1, [], list(removable)
    while rest:
        best = min(rest, key=lambda player: float(values[subset & ~(1 << player)]))
        subset &= ~(1 << best)
        order.append(best)
        rest.remove(best)
    return order
