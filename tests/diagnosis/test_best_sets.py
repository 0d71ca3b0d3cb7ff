"""The best sets of a quadratic model, against the enumeration of all of them with a solver of its own."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from made import LAWS, explanation
from scipy.optimize import lsq_linear

from eha_core.diagnosis.criteria import BEYOND
from eha_core.diagnosis.hypothesis import NOTHING, Member
from eha_core.diagnosis.search.best_sets import best_sets, objective_without, one_more
from eha_core.diagnosis.search.columns import Column
from eha_core.diagnosis.search.quadratic import Option, QuadraticModel

EMPTY = 5000.0
NAMED = sorted(effect.id for effect in LAWS.values() if effect.named and not effect.kind)
FRICTIONS = sorted(effect.id for effect in LAWS.values() if effect.kind == "dry friction")


def option(name, places, present=False):
    columns = () if present else tuple(Column(LAWS[name], {}, (), 0, False) for _ in places)
    return Option(Member(name, effect=LAWS[name]), tuple(places), columns)


def model_of(options, seed, one_way=(), correlated=1.0):
    """A model with a random positive definite curvature over these options' columns."""
    generator = np.random.default_rng(seed)
    size = 1 + max(place for one in options for place in one.places)
    factor = generator.standard_normal((3 * size, size)) + correlated * generator.standard_normal((3 * size, 1))
    factor /= np.linalg.norm(factor, axis=0)
    gradient = factor.T @ (20.0 * generator.standard_normal(3 * size))
    lower = np.full(size, -1e9)
    lower[list(one_way)] = 0.0
    return QuadraticModel(
        explanation({}), NOTHING, tuple(options), 0, factor.T @ factor, gradient, lower, np.full(size, 1e9),
        np.ones(size), EMPTY, np.zeros(size), np.zeros(0), np.zeros((0, size)),
    )  # fmt: skip


def predicted(model, chosen):
    """The least objective of a set by a solver of its own, None where an effect comes to nothing at its bound."""
    places = [place for one in chosen for place in one.places]
    if not places:
        return model.empty
    root = np.linalg.cholesky(model.matrix[np.ix_(places, places)])
    right = np.linalg.solve(root, model.gradient[places])
    found = lsq_linear(root.T, right, (model.lower[places], model.upper[places]), tol=1e-14)
    if np.any(np.isclose(found.x, model.lower[places], atol=1e-7)):
        return None
    return model.empty - float(right @ right - 2.0 * found.cost)


def enumerated(model, size):
    """Every set of a size that may be, as its options' places, and what is predicted of it."""
    found = {}
    for chosen in combinations(model.options, size):
        ids = [one.member.id for one in chosen]
        kinds = [one.member.effect.kind for one in chosen if one.member.effect.kind]
        if len(set(ids)) < size or len(set(kinds)) < len(kinds):
            continue
        value = predicted(model, chosen)
        if value is not None:
            found[frozenset(one.places for one in chosen)] = value
    return found


def test_each_size_has_its_best_set_first_and_all_are_predicted_right():
    for seed in range(8):
        model = model_of([option(name, [k]) for k, name in enumerate(NAMED[:9])], seed)
        found = best_sets(model, 4)
        assert sorted(found) == [0, 1, 2, 3, 4]
        assert found[0][0].predicted == EMPTY
        for size in range(1, 5):
            whole = enumerated(model, size)
            values = [proposal.predicted for proposal in found[size]]
            assert values == sorted(values)
            assert values[0] == pytest.approx(min(whole.values()))
            for proposal in found[size]:
                places = frozenset(one.places for one in proposal.options)
                assert proposal.predicted == pytest.approx(whole[places])


def test_sets_that_keep_what_is_present_are_the_best_of_those():
    for seed in range(8):
        options = [option(name, [k], present=k < 2) for k, name in enumerate(NAMED[:8])]
        model = model_of(options, seed)
        found = best_sets(model, 4, keeping=True)
        assert sorted(found) == [2, 3, 4]
        for size, level in found.items():
            assert all(proposal.options[:2] == tuple(options[:2]) for proposal in level)
            whole = [value for places, value in enumerated(model, size).items() if {(0,), (1,)} <= places]
            assert level[0].predicted == pytest.approx(min(whole))
        assert best_sets(model, 1, keeping=True) == {}


def test_sets_grow_little_beyond_the_size_that_pays():
    model = model_of([option(name, [k]) for k, name in enumerate(NAMED[:9])], 0)
    best = {size: level[0].predicted for size, level in best_sets(model, 9).items()}
    assert max(best) == 9
    for needed in (30.0, 300.0, 3000.0):
        pays = min(best, key=lambda size: best[size] + needed * size)
        found = best_sets(model, 9, needed)
        assert max(found) == min(9, pays + BEYOND + 1)
        assert all(found[size][0].predicted == best[size] for size in range(pays + 1))


def test_of_pairs_the_best_are_all_there():
    for seed in range(8):
        model = model_of([option(name, [k]) for k, name in enumerate(NAMED[:7])], seed)
        best = sorted(enumerated(model, 2).values())[:5]
        assert [proposal.predicted for proposal in best_sets(model, 2)[2]][:5] == pytest.approx(best)


def test_a_coefficient_that_may_not_be_negative_is_not():
    refused = 0
    for seed in range(12):
        options = [option(name, [k]) for k, name in enumerate(NAMED[:7])]
        model = model_of(options, seed, one_way=range(7), correlated=1.5)
        free = replace(model, lower=np.full(7, -1e9))
        for size, level in best_sets(model, 3).items():
            whole = enumerated(model, size)
            refused += len(enumerated(free, size)) - len(whole)
            for proposal in level:
                places = frozenset(one.places for one in proposal.options)
                assert proposal.predicted == pytest.approx(whole[places] if size else EMPTY)
                assert np.all(model.gain(proposal.options)[1] >= 0.0)
            if size == 1:
                assert level[0].predicted == pytest.approx(min(whole.values()))
    assert refused > 100


def test_two_forms_of_one_law_and_two_guesses_of_one_effect_exclude_each_other():
    names = [*FRICTIONS, NAMED[0], NAMED[0], NAMED[1], NAMED[2]]
    assert len(FRICTIONS) >= 3
    for seed in range(6):
        model = model_of([option(name, [k]) for k, name in enumerate(names)], seed)
        for size, level in best_sets(model, 4).items():
            for proposal in level:
                ids = [one.member.id for one in proposal.options]
                assert len(set(ids)) == len(ids)
                assert len(set(ids) & set(FRICTIONS)) <= 1
            if size:
                assert level[0].predicted == pytest.approx(min(enumerated(model, size).values()))


def test_an_option_of_several_columns_takes_all_of_them():
    names = NAMED[:6]
    for seed in range(6):
        model = model_of([option(name, [2 * k, 2 * k + 1]) for k, name in enumerate(names)], seed)
        for size, level in best_sets(model, 3).items():
            if size:
                assert level[0].predicted == pytest.approx(min(enumerated(model, size).values()))


def test_the_set_about_which_the_model_is_made_shrinks_and_grows():
    names = NAMED[:7]
    options = [option(name, [k], present=k < 3) for k, name in enumerate(names)]
    model = model_of(options, 3)
    whole = predicted(model, options[:3])
    members = [one.member for one in options]
    assert objective_without(model, ()) == pytest.approx(whole)
    for k in range(3):
        rest = [one for one in options[:3] if one is not options[k]]
        assert objective_without(model, [members[k]]) == pytest.approx(predicted(model, rest))
    assert objective_without(model, members[:3]) == pytest.approx(EMPTY)
    grown = {proposal.options[-1].member.id: proposal.predicted for proposal in one_more(model)}
    assert grown == {one.member.id: pytest.approx(predicted(model, [*options[:3], one])) for one in options[3:]}
