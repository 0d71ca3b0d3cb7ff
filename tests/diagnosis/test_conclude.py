"""What the conclusion may claim."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made import explanation

from eha_core.diagnosis import conclude
from eha_core.diagnosis.calibrate import Calibration
from eha_core.diagnosis.conclude import _law_site_first, _ordered, _unknown
from eha_core.diagnosis.effect_parameters import free_effect_parameters
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.experiment.discrimination import RATE
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.result import ChannelFit, Correlation, Explained, Location, UnknownLaw
from eha_core.diagnosis.search.comparison import Entry, ModelComparison
from eha_core.diagnosis.unknown import Recovery
from eha_core.diagnosis.verdict import Decision
from eha_core.effects import effects
from eha_core.identification.observation import Measured, Observation
from eha_core.identification.segments import cut
from eha_core.identification.validate import Judged
from eha_core.parameters import nominal_values
from eha_core.plant import PAPER, compose
from eha_core.recording import Recording

CURVE = next(effect for effect in effects() if effect.id == "recovered_force")


@pytest.mark.parametrize(("share", "expected"), [(0.3, False), (0.8, True)])
def test_a_function_that_leaves_more_than_it_explains_is_no_law(share, expected):
    speeds = np.linspace(-0.2, 0.2, 12)
    knots = tuple((float(speed), 3000.0 * float(speed)) for speed in speeds)
    evidence = SimpleNamespace(
        decision=SimpleNamespace(verdict="unknown_physics"),
        equation_residuals=(),
        recovery=Recovery(CURVE, "velocity", NOTHING.with_effects([CURVE]), explanation({}), 500.0, share, knots),
    )
    law = _unknown(evidence)
    assert (law is not None) == expected
    if law is not None:
        assert law.function_of == "velocity"
        assert law.expression == "3e3 v [N], v in m/s"


def test_a_curve_that_no_expression_fits_is_told_by_its_knots_alone():
    speeds = np.linspace(-0.2, 0.2, 12)
    forces = 300.0 * np.random.default_rng(6).standard_normal(12)
    knots = tuple(zip(speeds.tolist(), forces.tolist(), strict=True))
    evidence = SimpleNamespace(
        decision=SimpleNamespace(verdict="unknown_physics"),
        equation_residuals=(),
        recovery=Recovery(CURVE, "velocity", NOTHING.with_effects([CURVE]), explanation({}), 500.0, 0.8, knots),
    )
    law = _unknown(evidence)
    assert law is not None and law.expression == ""
    assert (law.site, law.function_of, law.r_squared, law.samples) == ("force", "velocity", 0.8, knots)


def test_the_site_of_the_named_effect_leads_and_takes_its_span():
    named, other, least = (Location(site, share, "everywhere", ((0.0, 9.0),)) for site, share in (
        ("force", 0.2), ("chamber", 0.7), ("sensor", 0.1)
    ))  # fmt: skip
    friction = next(effect for effect in effects() if effect.id == "coulomb_friction")
    assert friction.site == "force"
    acts = SimpleNamespace(values=dict(zip(friction.acting_names(), (2.0, 5.0), strict=True)))
    always = _ordered((least, other, named), Entry(NOTHING.with_effects([friction]), acts, 0.0))
    assert always == (named, other, least)
    first, *rest = _ordered((least, other, named), Entry(NOTHING.with_effects([friction], limited=True), acts, 0.0))
    assert (first.site, first.share, first.when) == ("force", 0.2, ((2.0, 5.0),))
    assert rest == [other, least]


def test_the_site_of_a_law_leads_and_is_told_once():
    seen = (Location("chamber", 0.6, "at large pressures", ((1.0, 2.0),)), Location("force", 0.3, "", ()))
    first, *rest = _law_site_first(UnknownLaw("force", "velocity", "3e3 v", 0.84, ()), seen)
    assert (first.site, first.share, first.where, first.when) == ("force", 0.84, "at large pressures", ((1.0, 2.0),))
    assert first.law_over == "velocity"
    assert rest == [seen[0]]
    (alone,) = _law_site_first(UnknownLaw("force", "velocity", "3e3 v", 0.84, ()), ())
    assert (alone.where, alone.when) == ("all over the states that were visited", ())


BALANCED = UnknownLaw("force", "velocity, times the load", "", 0.7, ())


@pytest.mark.parametrize(
    ("site", "share", "named", "found"),
    [
        ("force", 0.71, False, "velocity"),
        ("force", 0.69, False, BALANCED.function_of),
        ("force", 0.70, False, BALANCED.function_of),  # the residuals' law stands where the curve explains no more
        ("chamber", 0.99, False, BALANCED.function_of),  # another site's curve only compensates for the law
        ("force", 0.60, True, "velocity"),  # the residuals lack what is named, too
    ],
)
def test_the_law_is_the_balances_unless_a_curve_of_their_site_explains_more(site, share, named, found, monkeypatch):
    monkeypatch.setattr(conclude, "weak_law", lambda residuals: BALANCED)
    curve = next(effect for effect in effects() if not effect.named and effect.site == site)
    friction = [effect for effect in effects() if effect.id == "coulomb_friction" and named]
    knots = tuple((0.1 * k, 500.0 * k) for k in range(-5, 6))
    recovery = Recovery(
        curve, "velocity", NOTHING.with_effects([*friction, curve]), explanation({}), 500.0, share, knots
    )
    decision = SimpleNamespace(verdict="unknown_physics")
    evidence = SimpleNamespace(decision=decision, equation_residuals=(), recovery=recovery)
    law = _unknown(evidence)
    assert (law.site, law.function_of) == ("force", found)
    assert _unknown(replace_in(evidence, recovery=None)) == BALANCED
    assert _unknown(replace_in(evidence, decision=SimpleNamespace(verdict="missing_physics"))) is None


def replace_in(evidence, **changes):
    return SimpleNamespace(**{**vars(evidence), **changes})


@pytest.mark.parametrize("r_squared", [0.5, 0.49])
def test_a_law_explains_half_at_least(r_squared, monkeypatch):
    monkeypatch.setattr(conclude, "weak_law", lambda residuals: replace(BALANCED, r_squared=r_squared))
    decision = SimpleNamespace(verdict="unknown_physics")
    evidence = SimpleNamespace(decision=decision, equation_residuals=(), recovery=None)
    assert (_unknown(evidence) is None) is (r_squared < 0.5)


def test_a_curve_that_is_not_the_law_is_taken_out_of_the_model():
    nominal = Entry(NOTHING, explanation({}), 0.0)
    curved = Entry(NOTHING.with_effects([CURVE]), explanation({}), 99.0)
    judged = Judged(9.0, 3, {}, {}), Judged(3.0, 3, {}, {})
    decision = Decision("unknown_physics", curved, (), *judged)
    recovery = Recovery(CURVE, "velocity", curved.hypothesis, curved.fit, 99.0, 0.9, ())
    evidence = SimpleNamespace(decision=decision, recovery=recovery, comparison=ModelComparison(nominal, (), 1.0))
    same = UnknownLaw("force", "velocity", "", 0.9, ())
    assert conclude._without_another_curve(evidence, same) is decision
    elsewhere = [replace(same, site=site) for site in ("chamber", "valve")]
    for other in (None, *elsewhere, replace(same, function_of="position")):
        found = conclude._without_another_curve(evidence, other)
        assert (found.verdict, found.winner) == ("unknown_physics", nominal)
        assert found.judged_winner is found.judged_nominal is judged[0]
    named = replace(decision, verdict="missing_physics")
    assert conclude._without_another_curve(replace_in(evidence, decision=named), None) is named
    assert conclude._without_another_curve(replace_in(evidence, recovery=None), None) is decision


def observed(duration: float = 3.0, rate: float = 500.0, **changes) -> Observation:
    """A voltage of +-0.5 V and a position, with noise of 1e-5 m."""
    time = np.arange(round(duration * rate)) / rate
    voltage = np.where(time < 0.5 * duration, 0.5, -0.5)
    position = Measured("position", 0, time, 0.01 * np.sin(time), 1e-5)
    given = Observation("one.mcap", "voltage", ((time, voltage),), (position,), (), duration, (), (), ("late",))
    return replace(given, **changes)


def test_each_channels_error_is_told_on_the_windows_fitted_to_and_on_those_held_out(monkeypatch):
    shooting = cut(observed(), nominal_values())
    assert shooting.windows == 3  # the second is held out
    (sampling,) = shooting.samplings
    before = replace(explanation({}), residuals=(np.where(sampling.window == 1, 5.0, 3.0),))
    winner = Entry(NOTHING, explanation({}), 0.0)
    nominal, after = (
        Judged(0.0, 1, {"position": 2e-5}, {"position": 4e-5}),
        Judged(0.0, 1, {"position": 1e-5}, {"position": 3e-5}),
    )
    evidence = SimpleNamespace(calibration=SimpleNamespace(shooting=shooting))
    expected = conclude._channel_fits(evidence, before, None, Decision("missing_physics", winner, (), nominal, after))
    assert expected[0]["position"] == ChannelFit(pytest.approx(3e-5), 2e-5, 1e-5, 1e-5)
    assert expected[1]["position"] == ChannelFit(pytest.approx(5e-5), 4e-5, 3e-5, 1e-5)
    monkeypatch.setattr(conclude, "judge", lambda shooting, model: {"recalibrated": nominal}[model])
    expected = conclude._channel_fits(evidence, before, "recalibrated", Decision("consistent", winner, (), None, None))
    assert expected[1]["position"] == ChannelFit(pytest.approx(5e-5), 4e-5, 4e-5, 1e-5)


def test_remarks_name_their_recording_where_there_are_several_and_the_units_of_what_turns():
    def remarks(*observations, begun_anew=False, effects=("one",)):
        decision = SimpleNamespace(winner=SimpleNamespace(effects=effects))
        evidence = SimpleNamespace(observations=observations, observation=observations[0], decision=decision)
        searched = SimpleNamespace(begun_anew=begun_anew)
        return conclude._remarks(replace_in(evidence, comparison=searched))

    assert remarks(observed()) == ("late",)
    assert remarks(observed(), observed(path="two.mcap", remarks=("cut",))) == ("one.mcap: late", "two.mcap: cut")
    vane = compose(cylinder="rotary_vane")
    units, late = remarks(observed(composition=vane))
    assert late == "late" and "rad/s and N m" in units
    anew, late = remarks(observed(), begun_anew=True)
    assert late == "late" and "sought anew over longer ones" in anew
    assert remarks(observed(), begun_anew=True, effects=()) == ("late",)


def proposed(monkeypatch, observation: Observation, limits: Limits | None = None):
    """What `propose` is given of two rivals in this recording."""
    monkeypatch.setattr(conclude, "propose", lambda *given: given)
    shooting = cut(observation, nominal_values())
    sizes = {"constant_load.force": 200.0, "coulomb_friction.force": 250.0}
    two = [effect for effect in effects() if effect.id in ("constant_load", "coulomb_friction")]
    best, near = (Entry(NOTHING.with_effects([one]), explanation(sizes), 90.0) for one in two)
    comparison = ModelComparison(Entry(NOTHING, explanation({}), 0.0), (best, near), 1.0)
    evidence = SimpleNamespace(
        observation=observation, comparison=comparison, calibration=SimpleNamespace(shooting=shooting),
        shown=lambda windows: windows,
    )  # fmt: skip
    return conclude._experiment(evidence, Decision("ambiguous", best, (), None, None), limits), shooting


def test_the_next_experiment_is_made_for_the_rigs_valve_its_noise_and_the_voltage_it_has_seen(monkeypatch):
    (rivals, noises, used, limit, within), shooting = proposed(monkeypatch, observed(rate=2.0 * RATE))
    assert {ids for ids, _ in rivals} == {("constant_load",), ("coulomb_friction",)}
    # as many samples a second as the experiment has would have to be better, each, by the root of the ratio
    share = len(shooting.samplings[0].values) / (3.0 * 2.0 * RATE)
    assert noises == {"position": pytest.approx(1e-5 / np.sqrt(2.0 * share))}
    assert (used, limit) == (pytest.approx(0.5), pytest.approx(2.0))  # 20 mA through 100 ohm
    assert within is None
    gentle = Limits(voltage=0.7)
    assert proposed(monkeypatch, observed(), gentle)[0][3:] == (0.7, gentle)
    time = np.arange(1500) / 500.0
    still = observed(inputs=((time, np.zeros(1500)),))
    assert proposed(monkeypatch, still)[0][2] == pytest.approx(0.2)
    pressed = observed(drive="force", driving=("force",), inputs=((time, 9.0 * time),))
    assert proposed(monkeypatch, pressed)[0][2] == pytest.approx(0.2)


def test_no_experiment_is_proposed_for_a_source_that_no_voltage_drives():
    spool = compose("measured_spool")
    assert PAPER.source.valve == "coil" != spool.source.valve
    best = Entry(NOTHING.with_effects([effects()[0]]), explanation({}), 90.0)
    evidence = SimpleNamespace(
        observation=observed(composition=spool, driving=("spool",)),
        comparison=ModelComparison(Entry(NOTHING, explanation({}), 0.0), (best,), 1.0),
    )
    experiment = conclude._experiment(evidence, Decision("ambiguous", best, (), None, None), None)
    assert experiment.reference == {} and "spool of measured_spool come from the rig" in experiment.statement


JUDGED = Judged(0.0, 1, *(dict.fromkeys(("position", "position@2"), 2e-05) for _ in range(2)))
SEEN = (Location("chamber", 0.6, "", ()), Location("force", 0.3, "", ()))


@pytest.fixture
def _fitted_elsewhere(monkeypatch):
    """What the conclusion asks of fits and simulations, which have tests of their own."""
    monkeypatch.setattr(conclude, "polish", lambda evidence, winner: winner.fit)
    monkeypatch.setattr(conclude, "supported", lambda evidence, decision: decision)
    monkeypatch.setattr(conclude, "one_sided", lambda *given: {})
    monkeypatch.setattr(conclude, "judge", lambda shooting, model: JUDGED)
    monkeypatch.setattr(conclude, "explained", lambda *given: Explained(1.0, {"position": 1.0}, True))
    monkeypatch.setattr(conclude, "predictions", lambda *given: {})
    monkeypatch.setattr(conclude, "undetected", lambda *given: None)
    monkeypatch.setattr(conclude, "pictures", lambda *given: None)
    monkeypatch.setattr(conclude, "correlation", lambda final: Correlation())
    monkeypatch.setattr(conclude, "propose", lambda *given: "a test")
    order = ("coulomb_friction", "constant_load")
    monkeypatch.setattr(conclude, "ladder", lambda *given: ((), dict.fromkeys(order)))
    monkeypatch.setattr(conclude, "weak_law", lambda residuals: BALANCED)


def concluded(verdict: str, *names: str, rivals=(), lead: int = 1, damaged=(None, None)):
    chosen = [effect for effect in effects() if effect.id in names]
    observations = (observed(), observed(path="two.mcap", duration=6.0))
    shooting = conclude.cut_together(observations, nominal_values())
    left = tuple(np.zeros(len(one.values)) for one in shooting.samplings)
    size = {"constant_load.force": 200.0, "coulomb_friction.force": 250.0}
    free = [one for effect in chosen for one in free_effect_parameters(effect, {**nominal_values(), **size})]
    model = replace(explanation(size, tuple(free)), residuals=left)
    nominal, winner = Entry(NOTHING, model, 0.0), Entry(NOTHING.with_effects(chosen), model, 90.0)
    evidence = Evidence(
        observations, lead, nominal_values(), Calibration(shooting, None, model, model), None, (), (),
        ModelComparison(nominal, (winner,), 1.0), None, Decision(verdict, winner, rivals, None, None), SEEN,
    )  # fmt: skip
    recordings = [
        Recording(one.path, {}, 1000 * number, one.duration, {}, (), hurt, ())
        for number, (one, hurt) in enumerate(zip(observations, damaged, strict=True), 1)
    ]
    return conclude.conclude(recordings, evidence)


@pytest.mark.usefixtures("_fitted_elsewhere")
def test_the_conclusion_is_of_the_leading_recording_and_tells_of_any_that_is_damaged():
    for lead, path, duration, stamp in ((1, "one.mcap", 3.0, 1000), (2, "two.mcap", 6.0, 2000)):
        found = concluded("missing_physics", "coulomb_friction", lead=lead)
        assert (found.path, found.duration, found.start_stamp, found.damaged) == (path, duration, stamp, None)
        assert list(found.training) == ["position"] and len(found.together) == 2
    assert concluded("consistent", damaged=(None, "cut short")).damaged == "cut short"


@pytest.mark.usefixtures("_fitted_elsewhere")
@pytest.mark.parametrize(
    ("verdict", "sites"),
    [
        ("consistent", []),
        ("parameters", []),
        ("missing_physics", ["force", "chamber"]),
        ("unknown_physics", ["force", "chamber"]),
        ("ambiguous", ["force", "chamber"]),
    ],
)
def test_each_verdict_tells_a_place_a_law_and_a_further_test_where_it_has_one(verdict, sites):
    friction = next(effect for effect in effects() if effect.id == "coulomb_friction")
    rival = Entry(NOTHING.with_effects([friction]), explanation({}), 85.0)
    found = concluded(verdict, "constant_load", "coulomb_friction", rivals=((rival, 5.0),))
    assert found.verdict == verdict
    assert [one.site for one in found.location] == sites
    assert found.unknown == (BALANCED if verdict == "unknown_physics" else None)
    assert found.next_experiment == ("a test" if verdict == "ambiguous" else None)
    assert [(one.effects, one.evidence_gap) for one in found.alternatives] == [(("coulomb_friction",), 5.0)]


@pytest.mark.usefixtures("_fitted_elsewhere")
def test_effects_stand_in_the_order_in_which_they_matter():
    found = concluded("missing_physics", "constant_load", "coulomb_friction")
    assert [one.id for one in found.effects] == ["coulomb_friction", "constant_load"]


@pytest.mark.parametrize(("finer", "again"), [(5.0, False), (5.1, True)])
def test_the_winner_is_polished_at_the_final_step_and_further_where_that_leaves_it_far_from_noise(
    finer, again, monkeypatch
):
    runs = []

    def fit(problem, values, free, states, iterations):
        runs.append((problem.shooting.step_size, problem.windows.tolist(), iterations))
        return replace(explanation({}), data=finer * 100.0, count=100)

    monkeypatch.setattr(conclude, "fit", fit)
    monkeypatch.setattr(conclude, "with_residual", lambda problem, final: final)
    monkeypatch.setattr(conclude, "with_noise", lambda shooting, noise: shooting)
    monkeypatch.setattr(conclude, "corrected_noise", lambda *given: None)
    for coarse, step in ((2e-4, 1e-4), (5e-5, 5e-5)):
        runs.clear()
        searched = cut(observed(), nominal_values(), coarse)
        evidence = SimpleNamespace(
            observations=(observed(),), nominal=nominal_values(), calibration=SimpleNamespace(shooting=searched)
        )
        for before, goes_on in ((499.0, again), (520.0, False)):
            runs.clear()
            winner = Entry(NOTHING, replace(explanation({}), data=before, count=100), 0.0)
            conclude.polish(evidence, winner)
            assert [one[:2] for one in runs] == [(step, [0, 1, 2])] * (2 if goes_on else 1)
