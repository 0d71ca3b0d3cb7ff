"""Shapley's shares of a quantity that is known for each subset of some players, and the order of fastest reduction.

A subset is a whole number whose bit k is set if player k is in it; `values[subset]` is the quantity.

Source: L. S. Shapley, "A value for n-person games", Contributions to the Theory of Games II, Princeton 1953.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def players_of(values: Array) -> int:
    """The number of players n of (2^n,) values."""
    return len(values).bit_length() - 1


def shares(values: Array) -> Array:
    """Shares (n,) that add up to the complete set's value minus the empty one's.

    A player's share is the value that it adds, averaged over all orders in which the players can be added.
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
    """The quantity (n,) of the complete set without each player."""
    whole = len(values) - 1
    return values[[whole & ~(1 << player) for player in range(players_of(values))]]


def fastest_removal(values: Array, removable: Sequence[int]) -> list[int]:
    """The order in which these players are removed from the complete set, each time the one with the lowest rest."""
    subset, order, rest = len(values) - 1, [], list(removable)
    while rest:
        best = min(rest, key=lambda player: float(values[subset & ~(1 << player)]))
        subset &= ~(1 << best)
        order.append(best)
        rest.remove(best)
    return order
