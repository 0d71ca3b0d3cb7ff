"""Shares against the definition: the mean of what a player adds over every order of the players."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from eha_core.error_budget import shapley


def by_orders(values: np.ndarray, count: int) -> np.ndarray:
    added = np.zeros(count)
    orders = list(permutations(range(count)))
    for order in orders:
        subset = 0
        for player in order:
            added[player] += values[subset | 1 << player] - values[subset]
            subset |= 1 << player
    return added / len(orders)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_a_share_is_the_mean_over_all_orders(count: int) -> None:
    values = np.random.default_rng(count).normal(size=2**count)
    assert shapley.shares(values) == pytest.approx(by_orders(values, count), abs=1e-12)


def test_two_players_by_hand() -> None:
    values = np.array([10.0, 14.0, 11.0, 20.0])  # none, the first, the second, both
    assert shapley.shares(values).tolist() == [0.5 * (4.0 + 9.0), 0.5 * (1.0 + 6.0)]
    assert shapley.without_each(values).tolist() == [11.0, 14.0]
    assert shapley.fastest_removal(values, [0, 1]) == [0, 1]


def test_ten_players_add_up() -> None:
    values = np.random.default_rng(1).uniform(size=1024)
    assert np.sum(shapley.shares(values)) == pytest.approx(values[-1] - values[0], abs=1e-12)


def test_the_order_is_greedy_by_hand() -> None:
    values = np.full(8, 100.0)
    values[0b111], values[0b110], values[0b101], values[0b011] = 10.0, 9.0, 7.0, 8.0  # without 0, 1, 2
    values[0b100], values[0b001], values[0b000] = 4.0, 6.0, 1.0  # after 1: without 0, without 2
    assert shapley.fastest_removal(values, [0, 1, 2]) == [1, 0, 2]
    assert shapley.fastest_removal(values, [1, 2]) == [1, 2]
