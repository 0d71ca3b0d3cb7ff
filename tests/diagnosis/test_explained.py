"""What is said to be explained, to be left, and to be predicted: each against numbers made by hand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made import explanation, recorded

from eha_core.diagnosis import explained as stage
from eha_core.diagnosis.explained import explained, predictions
from eha_core.diagnosis.result import ChannelFit
from eha_core.effects import effects
from eha_core.identification.observation import observe
from eha_core.parameters import nominal_values

COUNT = 2000
WHITE = np.random.default_rng(3).standard_normal(COUNT)
WHITE /= np.sqrt(np.mean(WHITE**2))
COHERENT = np.sqrt(2.0) * np.sin(np.arange(COUNT) * 2.0 * np.pi / COUNT)


def fit(data: float, *residuals):
    return replace(explanation({}), data=data, count=COUNT, residuals=residuals)


def evidence(before: float, after: float, **sites: float):
    """Chi^2 of the recalibrated nominal model and of the winner; what a score test predicts at each site."""
    return SimpleNamespace(
        calibration=SimpleNamespace(shooting=SimpleNamespace(names=("position", "pressure_a"))),
        comparison=SimpleNamespace(nominal=SimpleNamespace(fit=fit(before)), left_over=sites),
        decision=SimpleNamespace(winner=SimpleNamespace(fit=fit(after), effects=())),
        observations=(),
        scales=None,
        lead=1,
    )


def held_out(**after: float):
    return {name: ChannelFit(9.0, 9.0, after.get(name, 0.5) * 4.0, 4.0) for name in ("position", "pressure_a")}


def test_the_share_is_of_what_the_nominal_model_leaves_beside_noise():
    final = fit(0.0, WHITE, 1.1 * WHITE)
    for before, after, share in (
        (20.0 * COUNT, 1.0 * COUNT, 1.0),
        (20.0 * COUNT, 5.75 * COUNT, 0.75),
        (20.0 * COUNT, 0.9 * COUNT, 1.0),
        (20.0 * COUNT, 25.0 * COUNT, 0.0),
        (0.9 * COUNT, 0.9 * COUNT, 1.0),
    ):
        found = explained(evidence(before, after), final, held_out())
        assert found.share == pytest.approx(share)
        assert found.times_noise == {"position": pytest.approx(1.0), "pressure_a": pytest.approx(1.1)}
        assert found.complete and found.left_over == ()


@pytest.mark.parametrize("left", [1.25 * WHITE, 1.1 * COHERENT])
def test_what_is_loud_or_coherent_in_one_channel_is_left_over_at_the_sites_that_tell_most(left, monkeypatch):
    monkeypatch.setattr(stage, "whereabouts", lambda *_: ("near zero speed", ((1.0, 2.0),)))
    sites = {"force": 20.0, "valve": 70.0, "sensor": 4.0, "orifice": 6.0}
    found = explained(evidence(20.0 * COUNT, 2.0 * COUNT, **sites), fit(0.0, WHITE, left), held_out())
    assert not found.complete
    assert [(one.site, one.share) for one in found.left_over] == [("valve", 0.7), ("force", 0.2), ("orifice", 0.06)]
    assert {one.when for one in found.left_over} == {((1.0, 2.0),)}
    few = {"force": 96.0, "valve": 4.0}
    (alone,) = explained(evidence(20.0 * COUNT, 2.0 * COUNT, **few), fit(0.0, WHITE, left), held_out()).left_over
    assert (alone.site, alone.share) == ("force", 0.96)


def test_what_is_left_on_held_out_windows_alone_is_left_too(monkeypatch):
    monkeypatch.setattr(stage, "whereabouts", lambda *_: ("near zero speed", ((1.0, 2.0),)))
    for ratio, complete in ((1.1, True), (1.54, False)):
        rested = held_out(pressure_a=ratio)
        found = explained(evidence(20.0 * COUNT, 1.0 * COUNT, force=9.0), fit(0.0, WHITE, 1.05 * WHITE), rested)
        assert found.complete is complete
        assert found.times_noise == {"position": pytest.approx(1.0), "pressure_a": pytest.approx(ratio)}


def test_the_true_model_predicts_to_the_noise_and_a_wrong_one_worse_the_further_it_runs():
    observation = observe(recorded({}, duration=3.0, noise=3.0))
    found = predictions(observation, nominal_values(), 1e-4)
    assert set(found) == {"position", "pressure_a", "pressure_b"}
    for name in ("pressure_a", "pressure_b"):
        assert set(found[name].ahead) == {0.25, 1.0}
        assert (*found[name].ahead.values(), found[name].free_running) == pytest.approx((3e4,) * 3, rel=0.05)
    wrong = predictions(observation, {**nominal_values(), "valve_null_offset.offset": 2e-5}, 1e-4)["position"]
    assert 3e-5 < wrong.ahead[0.25] < wrong.ahead[1.0] < wrong.free_running
    clean = observe(recorded({}, duration=1.5, noise=0.0))
    short = predictions(clean, nominal_values(), 1e-4)["position"]
    assert short.ahead[0.25] < 1e-7


@pytest.mark.parametrize(("deviation", "complete"), [(5.9e5, False), (100.0, True)])
def test_an_effect_of_any_size_completes_no_result(deviation, complete, monkeypatch):
    """18 kN of friction are estimated with 593 kN or with 100 N to either side."""
    monkeypatch.setattr(stage, "whereabouts", lambda *_: ("near zero speed", ((1.0, 2.0),)))
    (friction,) = [effect for effect in effects() if effect.id == "coulomb_friction"]
    seen = evidence(20.0 * COUNT, 1.0 * COUNT, force=1.0)
    seen.decision.winner.effects = (friction,)
    final = fit(0.0, WHITE, WHITE)
    final = replace(final, free=(SimpleNamespace(name="coulomb_friction.force"),))
    final = replace(final, values={**final.values, "coulomb_friction.force": 1.8e4})
    monkeypatch.setattr(type(final), "deviation", lambda *_: deviation)
    assert explained(seen, final, held_out()).complete is complete
