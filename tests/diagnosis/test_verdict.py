"""What is decided of scored hypotheses, without any fit: every branch, and each threshold from both sides."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made import explanation

from eha_core.diagnosis import criteria, verdict
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.comparison import Entry, ModelComparison
from eha_core.diagnosis.unknown import Recovery
from eha_core.effects import effects

LAWS = {effect.id: effect for effect in effects()}
COUNT = 2000
WHITE = np.random.default_rng(1).standard_normal(COUNT)
COHERENT = 2.0 * np.sin(np.arange(COUNT) * 2.0 * np.pi / COUNT)


def fit(data: float, residual=WHITE, objective: float | None = None):
    given = data if objective is None else objective
    return replace(explanation({}), data=data, objective=given, count=COUNT, residuals=(residual,), free=())


NOMINAL = Entry(NOTHING, fit(20.0 * COUNT), 0.0)


def entry(score: float, *names: str, of=None) -> Entry:
    return Entry(NOTHING.with_effects([LAWS[name] for name in names]), of or fit(1.0 * COUNT), score)


def recovered(
    score: float, data: float = 1.0 * COUNT, objective: float | None = None, beside: tuple[str, ...] = (), share=1.0
) -> Recovery:
    law = LAWS["recovered_force"]
    named = NOTHING.with_effects([LAWS[name] for name in beside])
    hypothesis = named.with_effects([law], variable="velocity")
    return Recovery(law, "velocity", hypothesis, fit(data, objective=objective), score, share, ())


@pytest.fixture(autouse=True)
def _held_out(monkeypatch):
    """Held-out chi^2 is the fit's own data; no effect of these fits lies at a bound."""
    monkeypatch.setattr(verdict, "judge", lambda _, one, instants=(): SimpleNamespace(chi_square=one.data))
    monkeypatch.setattr(verdict, "instants_of", lambda one: ())
    monkeypatch.setattr(verdict, "bounded", lambda one: one.cost < 0.0)
    monkeypatch.setattr(verdict, "has_changed", lambda result, nominal, name: name in nominal)


def decide(
    *entries: Entry, nominal: Entry = NOMINAL, recovery=None, before: float = 0.0, named=(), residual_variance=1.0
):
    calibration = SimpleNamespace(shooting=None, nominal=SimpleNamespace(objective=nominal.fit.objective + before))
    comparison = ModelComparison(nominal, entries, residual_variance)
    return verdict.decide(calibration, dict.fromkeys(named, 1.0), comparison, recovery)


def test_the_best_is_named_alone_where_the_next_lies_a_tie_behind():
    best = entry(500.0, "coulomb_friction")
    for behind, found in ((9.9, "ambiguous"), (10.0, "missing_physics")):
        decision = decide(best, entry(500.0 - behind, "constant_load"))
        assert (decision.verdict, decision.winner.ids) == (found, ("coulomb_friction",))
        assert [round(gap, 6) for _, gap in decision.rivals] == ([9.9] if found == "ambiguous" else [])
        assert decision.judged_nominal.chi_square == 20.0 * COUNT
        assert decision.judged_winner.chi_square == COUNT


def test_what_only_adds_to_the_winner_is_no_rival():
    best = entry(500.0, "coulomb_friction")
    assert decide(best, entry(499.0, "coulomb_friction", "constant_load")).verdict == "missing_physics"
    both = entry(500.0, "coulomb_friction", "constant_load")
    assert decide(both, entry(499.0, "coulomb_friction")).verdict == "ambiguous"


def test_contenders_lie_within_two_ties_and_at_no_bound():
    best, near, far = entry(500.0, "coulomb_friction"), entry(480.5, "constant_load"), entry(480.0, "end_stop")
    held = replace(entry(499.0, "hardening_spring"), cost=-1.0)
    found = verdict.contenders(best, ModelComparison(NOMINAL, (best, held, near, far), 1.0))
    assert [one.ids for one in found] == [("coulomb_friction",), ("constant_load",)]


@pytest.mark.parametrize(("score", "found"), [(20.0, "consistent"), (20.1, "missing_physics")])
def test_a_name_needs_enough_score(score, found):
    nominal = replace(NOMINAL, fit=fit(1.2 * COUNT))
    assert decide(entry(score, "coulomb_friction"), nominal=nominal).verdict == found


def test_an_effect_at_its_bound_is_passed_over():
    held = replace(entry(600.0, "coulomb_friction"), cost=-1.0)
    assert decide(held, entry(500.0, "constant_load")).winner.ids == ("constant_load",)
    assert decide(held, entry(599.0, "constant_load")).rivals == ()


@pytest.mark.parametrize(("gain", "found"), [(4.9, "consistent"), (5.0, "missing_physics"), (5.1, "missing_physics")])
def test_a_name_must_predict_what_was_held_out(gain, found):
    nominal = replace(NOMINAL, fit=fit(COUNT + 3.0 * gain))
    assert decide(entry(500.0, "coulomb_friction"), nominal=nominal, residual_variance=3.0).verdict == found


def test_what_is_left_coherent_large_and_unexplained_has_no_name():
    left = {"of": fit(6.0 * COUNT, COHERENT)}
    decision = decide(entry(500.0, "coulomb_friction", **left))
    assert decision.verdict == "unknown_physics" and decision.winner is NOMINAL
    assert decision.judged_winner is decision.judged_nominal
    for named in (
        fit(6.0 * COUNT, WHITE),  # outliers, but nothing that hangs together
        fit(4.7 * COUNT, COHERENT),  # less than a fifth of what there was
    ):
        assert decide(entry(500.0, "coulomb_friction", of=named)).verdict == "missing_physics"
    small = replace(NOMINAL, fit=fit(1.5 * COUNT, COHERENT))
    assert decide(entry(500.0, "coulomb_friction", of=fit(1.29 * COUNT, COHERENT)), nominal=small).verdict != (
        "unknown_physics"
    )
    assert decide(entry(500.0, "coulomb_friction", of=fit(1.3 * COUNT, COHERENT)), nominal=small).verdict == (
        "unknown_physics"
    )
    worst_of_two = replace(fit(6.0 * COUNT), residuals=(WHITE, COHERENT))
    assert decide(entry(500.0, "coulomb_friction", of=worst_of_two)).verdict == "unknown_physics"


def test_a_curve_stands_where_no_name_does():
    bad = entry(500.0, "coulomb_friction", of=fit(6.0 * COUNT, COHERENT))
    decision = decide(bad, recovery=recovered(20.1, objective=6.0 * COUNT))
    assert decision.verdict == "unknown_physics" and decision.winner.ids == ("recovered_force",)
    assert decision.winner.score == 20.1 and decision.judged_winner.chi_square == COUNT
    assert decision.judged_nominal.chi_square == 20.0 * COUNT
    assert decide(bad, recovery=recovered(20.0, objective=6.0 * COUNT)).winner is NOMINAL


def knots_cost(effects_parameters: int, variance: float = 1.0) -> float:
    return (verdict.KNOTS - effects_parameters) * verdict.parameter_cost(COUNT, variance)


@pytest.mark.parametrize(("more", "found"), [(-1.0, "missing_physics"), (1.0, "unknown_physics")])
def test_a_curve_beats_the_catalogue_by_a_margin_and_its_knots(more, found):
    named = entry(500.0, "constant_load", of=fit(4.0 * COUNT))
    own = len(LAWS["constant_load"].parameters)
    objective = 4.0 * COUNT - (criteria.UNKNOWN_MARGIN + knots_cost(own)) - more
    assert decide(named, recovery=recovered(100.0, objective=objective)).verdict == found


@pytest.mark.parametrize(("more", "found"), [(-1.0, "missing_physics"), (1.0, "unknown_physics")])
def test_the_margin_of_a_curve_is_counted_in_what_it_leaves_a_sample(more, found):
    named = entry(500.0, "constant_load", of=fit(4.0 * COUNT))
    own = len(LAWS["constant_load"].parameters)
    needed = 2.5 * (criteria.UNKNOWN_MARGIN + knots_cost(own, 2.5))
    curve = recovered(100.0, data=2.5 * COUNT, objective=4.0 * COUNT - needed - more)
    assert decide(named, recovery=curve).verdict == found


def test_a_curve_far_above_the_noise_does_not_beat_a_name_that_explains_nearly_all():
    named = entry(500.0, "constant_load", of=fit(2.8 * COUNT, objective=1e6))
    for data, found in ((criteria.FAR_FROM_NOISE * COUNT * 1.01, "missing_physics"), (COUNT, "unknown_physics")):
        assert decide(named, recovery=recovered(100.0, data=data, objective=0.0)).verdict == found
    half = entry(500.0, "constant_load", of=fit(3.0 * COUNT, objective=1e6))  # leaves more than a tenth
    far = recovered(100.0, data=criteria.FAR_FROM_NOISE * COUNT * 1.01, objective=0.0)
    assert decide(half, recovery=far).verdict == "unknown_physics"


@pytest.mark.parametrize(
    ("name", "left", "found"),
    [
        ("form_of_the_site", 0.049, "missing_physics"),
        ("form_of_the_site", 0.051, "unknown_physics"),
        ("form_elsewhere", 0.049, "unknown_physics"),
        ("form_elsewhere", 0.0049, "missing_physics"),
        ("form_elsewhere", 0.0051, "unknown_physics"),
        ("exact", 0.001, "unknown_physics"),
    ],
)
def test_a_curve_that_draws_the_named_law_in_its_other_form_leaves_it_its_name(name, left, found):
    site = LAWS["recovered_force"].site
    law = {
        "form_of_the_site": next(one for one in LAWS.values() if one.approximate and one.site == site),
        "form_elsewhere": next(one for one in LAWS.values() if one.approximate and one.site != site),
        "exact": LAWS["constant_load"],
    }[name]
    assert law.approximate is (name != "exact")
    named = entry(500.0, law.id, of=fit((1.0 + 19.0 * left) * COUNT, objective=1e6))
    assert decide(named, recovery=recovered(100.0, objective=0.0)).verdict == found


@pytest.mark.parametrize(("gain", "found"), [(-1.0, "consistent"), (1.0, "parameters")])
def test_parameters_differ_where_the_data_say_so_together(gain, found):
    calm = replace(NOMINAL, fit=replace(fit(1.2 * COUNT), free=(SimpleNamespace(name="moving_mass"),)))
    threshold = 2.0 * (criteria.ENOUGH + np.log(COUNT))
    how = {"nominal": calm, "before": threshold + gain, "residual_variance": 2.0}
    decision = decide(named=("moving_mass",), **how)
    assert decision.verdict == found and decision.winner is calm and decision.judged_winner is None
    assert decide(named=(), **how).verdict == "consistent"


def test_coherence_is_one_for_white_noise_and_nothing_for_what_is_too_short():
    long = np.random.default_rng(2).standard_normal(200_000)
    assert verdict.coherence(long) == pytest.approx(1.0, abs=0.02)
    assert verdict.coherence(np.ones(59)) == 0.0
    assert verdict.coherence(np.ones(60)) == pytest.approx(np.sqrt(20.0) / 0.6745, rel=1e-3)
    assert verdict.coherence(np.concatenate([np.ones(60), np.full(19, 1e9)])) == verdict.coherence(np.ones(60))


def test_whiteness_counts_in_deviations_of_white_noise():
    n, period = 1000, 8
    wave = np.cos(2.0 * np.pi * np.arange(n) / period)
    white, found = verdict.whiteness([WHITE[:n], wave + 3.0])
    assert white < 4.0 < found
    assert verdict.whiteness([WHITE[:n] + 3.0])[0] == pytest.approx(white)  # an offset is no memory
    assert found == pytest.approx(np.sqrt(n) * (1.0 - 4.0 / n), rel=2e-3)  # the overlap at half a period
    assert verdict.whiteness([np.zeros(50)]) == [0.0]
    assert verdict.whiteness([np.array([1.0, -1.0])]) == [0.0]
    sparse = np.zeros(200)
    sparse[[50, 70]] = 1.0
    at_20 = verdict.whiteness([sparse], lags=20)[0]
    beside = np.zeros(200)
    beside[[50, 69]] = 1.0
    assert verdict.whiteness([sparse]) == [at_20] and verdict.whiteness([beside])[0] > 10.0 * at_20
    assert verdict.whiteness([sparse], lags=21)[0] > 10.0 * at_20


@pytest.mark.parametrize(("share", "found"), [(0.49, "missing_physics"), (0.5, "unknown_physics")])
def test_a_curve_beside_a_named_effect_must_be_a_law_of_what_that_leaves(share, found):
    named = entry(500.0, "constant_load", of=fit(2.0 * COUNT, objective=1e6))
    decision = decide(named, recovery=recovered(600.0, objective=0.0, beside=("constant_load",), share=share))
    assert decision.verdict == found
    assert "constant_load" in decision.winner.ids
