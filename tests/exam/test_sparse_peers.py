"""Selection by BIC and by held-out blocks, on regressions whose terms are known."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from eha_exam.peers.equations import Array, Equation
from eha_exam.peers.localising import BLOCKS, CLEAR, MARGIN, held_out, localise
from eha_exam.peers.methods import diagnose_rows, forward_bic

NAMES = ("coulomb_friction", "quadratic_damping", "constant_load", "hardening_spring")
ROWS = 1000


def drawn(*columns: int, seed: int = 0) -> Array:
    return np.random.default_rng(seed).standard_normal((ROWS, *columns))


def regression(sizes: list[float], noise: float = 1.0, seed: int = 0, names: tuple[str, ...] = NAMES) -> Equation:
    """A force balance of three nominal terms, of candidates of these sizes and of white noise."""
    nominal, candidates = drawn(3, seed=seed), drawn(len(sizes), seed=seed + 1)
    target = nominal @ [2.0, -1.0, 0.5] + candidates @ sizes + noise * drawn(seed=seed + 2)
    return Equation("force", target, nominal, candidates, names, drawn(6, seed=seed + 3))


@pytest.mark.parametrize("planted", range(len(NAMES)))
def test_a_planted_term_is_found_and_no_other(planted: int) -> None:
    row = regression([1.0 * (j == planted) for j in range(len(NAMES))])
    assert forward_bic([row]) == [NAMES[planted]]
    found = localise(row)
    assert (found.terms, found.rivals) == ((NAMES[planted],), ((),))
    assert found.explained == pytest.approx(0.5, abs=0.06)


def test_noise_has_no_terms() -> None:
    row = regression([0.0] * 4)
    assert forward_bic([row]) == []
    assert localise(row).terms == ()
    assert diagnose_rows("localising_regression", [row])["verdict"] == "parameters"


def test_an_effect_of_two_equations_is_judged_by_both() -> None:
    sides = [regression([0.3, 0.0, 0.0, 0.0], seed=seed) for seed in (10, 20)]
    assert [forward_bic([side]) for side in sides] == [[], []]
    assert forward_bic(sides) == [NAMES[0]]


def test_a_proxy_that_was_taken_first_is_dropped_for_what_it_stands_for() -> None:
    row = regression([1.0, 0.6, 0.0, 0.0], noise=0.2)
    row.candidates[:, 2] = row.candidates[:, 0] + row.candidates[:, 1] + 0.3 * drawn(seed=9)
    alone = [
        float(np.linalg.norm(row.candidates[:, j] @ row.target) / np.linalg.norm(row.candidates[:, j]))
        for j in range(3)
    ]
    assert max(alone) == alone[2]
    assert set(forward_bic([row])) == {NAMES[0], NAMES[1]}


def test_a_held_out_block_is_predicted_from_rows_that_share_no_sample_with_it() -> None:
    row = regression([0.6, 0.0, 0.0, 0.0])
    errors = held_out(row, [0, 2])
    columns = np.column_stack([row.nominal, row.candidates[:, 0], row.candidates[:, 2]])
    far = np.r_[0:294, 406:ROWS]  # a bump is as wide as six steps to the next
    normal = columns[far].T @ columns[far]
    sizes = np.linalg.solve(normal, columns[far].T @ row.target[far])
    left = row.target[300:400] - columns[300:400] @ sizes
    assert errors[3] == pytest.approx(left @ left, rel=1e-9)
    within = replace(row, target=row.target + 100.0 * (np.arange(ROWS) // 100 == 3))
    assert held_out(within, [0, 2])[3] > 100.0 * errors[3]


@pytest.mark.parametrize(("share", "named"), [(0.4 * MARGIN, ()), (2.0 * MARGIN, (NAMES[1],))])
def test_a_term_must_lower_the_held_out_error_by_the_margin(share: float, named: tuple[str, ...]) -> None:
    size = float(np.sqrt(share / (1.0 - share)))
    row = regression([0.0, size, 0.0, 0.0])
    assert held_out(row, [1]).sum() < held_out(row, []).sum()
    assert localise(row).terms == named


def test_a_term_must_help_in_nearly_all_blocks() -> None:
    row = regression([0.0] * 4)
    acts = np.arange(ROWS) < ROWS * 0.7
    passing = replace(row, target=row.target + 2.0 * acts * row.candidates[:, 3])
    assert localise(passing).terms == ()
    always = replace(row, target=row.target + 2.0 * row.candidates[:, 3])
    assert localise(always).terms == (NAMES[3],)
    assert held_out(row, []).shape == (BLOCKS,)


def test_terms_that_stand_for_one_another_are_stated_as_alternatives() -> None:
    row = regression([1.0, 0.0, 0.0, 0.0])
    row.candidates[:, 2] = row.candidates[:, 0] + 0.1 * drawn(seed=9)
    answer = diagnose_rows("localising_regression", [row])
    assert (answer["verdict"], answer["alternatives"]) == ("ambiguous", [{"effects": [NAMES[2]]}])
    assert [one["id"] for one in answer["effects"]] == [NAMES[0]]


def test_a_site_is_clear_where_no_single_term_is() -> None:
    """Of twenty terms each explains less than the margin, and all together most."""
    names = tuple(f"term {j}" for j in range(30))
    row = regression([0.2] * 30, noise=0.5, names=names)
    quiet = regression([0.0] * 4, seed=40)
    found = localise(row)
    assert found.terms == () and found.explained_by_all > CLEAR > localise(quiet).explained_by_all
    answer: dict[str, Any] = diagnose_rows("localising_regression", [replace(quiet, site="chamber"), row])
    assert (answer["verdict"], answer["unknown"]["site"]) == ("unknown_physics", "force")


def test_the_site_named_first_is_the_balance_of_which_most_is_explained() -> None:
    much, little = regression([2.0, 0.0, 0.0, 0.0]), regression([0.8], seed=50, names=("valve_deadband",))
    for rows in ([much, little], [little, much]):
        answer = diagnose_rows("localising_regression", rows)
        assert [one["site"] for one in answer["location"]] == ["force", "orifice"]
