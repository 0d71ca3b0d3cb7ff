"""Stage 5, support: the decision, limited to what the recording supports.

The interval of a named effect's strength may include zero, and a model may predict worse than the nominal one before
anything was fitted.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from scipy.stats import chi2

from eha_core.diagnosis.calibrate import corrected_noise, filtered_channels
from eha_core.diagnosis.criteria import CERTAINTY, COHERENT, HELD_OUT, LEFT_IN_A_CHANNEL, TO_THE_END
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.explained import is_identified, root_mean_square
from eha_core.diagnosis.hypothesis import NOTHING, Member, without_effect
from eha_core.diagnosis.search.comparison import Entry
from eha_core.diagnosis.verdict import Decision, coherence, without_physics
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.intervals import at_its_end, with_residual
from eha_core.identification.profile import Ends, profile_interval
from eha_core.identification.validate import instants_of, judge


def supported(evidence: Evidence, decision: Decision) -> Decision:
    """The decision without unidentified effects, and never worse than the nominal model on held-out data."""
    if decision.verdict in ("missing_physics", "ambiguous"):
        decision = _without_unidentified(evidence, decision)
    return _no_worse_than_nominal(evidence, decision)


def _with_winner(evidence: Evidence, decision: Decision, winner: Entry) -> Decision:
    judged = judge(evidence.calibration.shooting, winner.fit, instants_of(winner.fit))
    return replace(decision, winner=winner, judged_winner=judged)


def _without_unidentified(evidence: Evidence, decision: Decision) -> Decision:
    """The decision without the effects whose strength the recording does not distinguish from zero."""
    problem, variance = evidence.calibration.problem, evidence.comparison.residual_variance
    before, winner = decision.winner, decision.winner
    doubtful = _unidentified(with_residual(problem, winner.fit), winner.hypothesis.members)
    for member in doubtful:
        values, free = without_effect(winner.fit, member.effect)
        less = fit(problem, values, free, winner.fit.states, iterations=TO_THE_END)
        lost = less.objective - winner.fit.objective
        if lost < chance(evidence, winner.fit, member.effect):
            winner = Entry(winner.hypothesis.without(member), less, winner.score - lost / variance)
    if winner is before:
        return decision
    if not winner.effects:
        return without_physics(evidence.calibration, evidence.nominal, evidence.comparison)
    rivals = tuple((entry, gap) for entry, gap in decision.rivals if entry.hypothesis != winner.hypothesis)
    verdict = "ambiguous" if rivals else "missing_physics"
    return _with_winner(evidence, replace(decision, verdict=verdict, rivals=rivals), winner)


def _unidentified(result: Fit, members: tuple[Member, ...]) -> list[Member]:
    return [member for member in members if member.effect.named and not is_identified(member.effect, result)]


def chance(evidence: Evidence, result: Fit, effect: Effect) -> float:
    """The gain in chi^2 that chance exceeds in one recording of twenty; larger where the residual is correlated."""
    _, wider = at_its_end(evidence.calibration.problem, result)
    names = set(effect.parameter_names())
    own = [width for parameter, width in zip(result.free, wider, strict=True) if parameter.name in names]
    ordinary = max(1.0, result.data / max(result.count, 1)) * max(own, default=1.0) ** 2
    return float(chi2.ppf(CERTAINTY, max(1, len(own)))) * ordinary


def one_sided(evidence: Evidence, final: Fit, winner: Entry) -> Mapping[str, Ends]:
    """The 95 % intervals, by profile likelihood, of the strengths that two deviations do not distinguish from zero."""
    found, problem = {}, evidence.calibration.problem
    for member in _unidentified(final, winner.hypothesis.members):
        effect = member.effect
        cost = chance(evidence, winner.fit, effect)
        for name, row in zip(effect.parameter_names(), effect.parameters, strict=True):
            free = any(parameter.name == name and not parameter.above for parameter in winner.fit.free)
            if free and row.switches and winner.fit.values[name] != row.nominal:
                found[name] = profile_interval(problem, winner.fit, name, row.nominal, cost)
    return found


def _no_worse_than_nominal(evidence: Evidence, decision: Decision) -> Decision:
    """The decision, or the nominal model as given where that is better on held-out data."""
    calibration, winner = evidence.calibration, decision.winner
    given = calibration.nominal
    instants = instants_of(winner.fit)
    after = decision.judged_winner or judge(calibration.shooting, winner.fit, instants)
    before = judge(calibration.shooting, given, instants)
    worse = (after.chi_square - before.chi_square) / evidence.comparison.residual_variance
    if not worse > HELD_OUT:
        return decision
    nominal = Entry(NOTHING, given, 0.0)
    verdict = "consistent" if _is_at_the_noise(evidence, given) else "unknown_physics"
    return Decision(verdict, nominal, (), before, before, as_given=True)


def _is_at_the_noise(evidence: Evidence, result: Fit) -> bool:
    """Whether a model's residual is noise in every channel."""
    shooting = evidence.calibration.shooting
    noises = corrected_noise(shooting, result, filtered_channels(evidence.observations))
    left = (
        (sampling.noise / noise * root_mean_square(residual), coherence(residual))
        for sampling, noise, residual in zip(shooting.samplings, noises, result.residuals, strict=True)
    )
    return all(size < LEFT_IN_A_CHANNEL and together < COHERENT for size, together in left)
