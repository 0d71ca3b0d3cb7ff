"""`diagnose`: the stages in their order, from recordings of a rig to a frozen result."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from threadpoolctl import threadpool_limits

from eha_core.diagnosis.attribution import attribute
from eha_core.diagnosis.calibrate import (
    Calibration,
    calibrate,
    calibrate_but_for_the_ends,
    calibrate_finely_enough,
)
from eha_core.diagnosis.characteristic_scales import Scales, characteristic_scales
from eha_core.diagnosis.conclude import conclude
from eha_core.diagnosis.criteria import FAR_FROM_NOISE, NEAR_NOISE, OVER, chance_gain
from eha_core.diagnosis.evidence import Evidence, telling_most
from eha_core.diagnosis.result import Diagnosis
from eha_core.diagnosis.search.found import Progress
from eha_core.diagnosis.search.initial_guesses import applicable_effects
from eha_core.diagnosis.search.model_comparison import ModelComparison as SinglesAndSets
from eha_core.diagnosis.search.model_comparison import compete, site_gains
from eha_core.diagnosis.search.sets import with_sets
from eha_core.diagnosis.sets.comparison import Entry, ModelComparison
from eha_core.diagnosis.sets.course import find_sets
from eha_core.diagnosis.unknown import recover
from eha_core.diagnosis.verdict import decide
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.free_parameters import not_believed
from eha_core.identification.observation import Observation, observe, with_sufficient_stroke
from eha_core.identification.parallel import side_by_side
from eha_core.identification.per_recording import base_name
from eha_core.identification.together import check_alike, fit_alone, recording_alone
from eha_core.nominal import NominalModel
from eha_core.recording import Recording
from eha_core.weak_form.equation_residuals import EquationResidual, equation_residuals, smallest

BEYOND = 20
"""Iterations of a model without the bounds that it rests on, before all else is asked again without them."""

SEARCHES = ("stepwise", "whole-sets")
"""How effects are found: single ones first and then sets of them, or whole sets at once. The second takes the first
one's place once it answers at least as many recordings right: see docs/exam.md."""

RIVALS = 5
"""How many of the best are asked whether they would lead without the bounds that they rest on."""


@dataclass(frozen=True)
class _Singles:
    """What is known before sets are tried: each stage's result up to the comparison of single effects."""

    nominal: Mapping[str, float]
    observations: tuple[Observation, ...]
    calibration: Calibration
    scales: Scales
    applicable: Sequence[Effect]
    comparison: SinglesAndSets


def examine(
    recordings: Sequence[Recording],
    model: NominalModel,
    progress: Progress = lambda _: None,
    search: str = SEARCHES[0],
) -> Evidence:
    """Run the stages up to the decision; once more without the bounds that the model found rests on.

    `search`: one of SEARCHES.

    How far a nominal value is believed must not decide which physics is named. Where a single effect explains nearly
    all without its bounds, no set is grown within them first. Raises RecordingError where a recording cannot be used.
    """
    if search == "whole-sets":
        return _over_whole_sets(recordings, model, progress)
    singles = _single_effects(recordings, model, progress)
    bounds = _held_back_alone(singles) - model.unknown
    if bounds:
        model = _without(model, bounds, progress)
        singles = _single_effects(recordings, model, progress)
    evidence = _with_sets(singles, progress)
    bounds = _holding_back(evidence) - model.unknown
    if not bounds:
        return evidence
    again = _with_sets(_single_effects(recordings, _without(model, bounds, progress), progress), progress)
    gain = evidence.decision.winner.fit.objective - again.decision.winner.fit.objective
    needed = chance_gain(again.calibration.problem.count(), again.comparison.residual_variance)
    return again if gain > needed else evidence


def _without(model: NominalModel, bounds: frozenset[str], progress: Progress) -> NominalModel:
    """The model with parameters that go as far as a recording leads them."""
    progress(f"once more: {', '.join(sorted(bounds))} went as far as believed of it")
    return replace(model, unknown=model.unknown | bounds)


def _held_back_alone(singles: _Singles) -> frozenset[str]:
    """The prior bounds without which the nominal model or a single effect explains nearly all that the best of them
    leaves within them, if that is far from noise: else a set that stays within them is near."""
    count, comparison = singles.calibration.problem.count(), singles.comparison
    leading = [entry.fit for entry in (comparison.nominal, *comparison.entries[:RIVALS])]
    best = min(leading, key=lambda at: at.objective)
    if best.data < FAR_FROM_NOISE * best.count:
        return frozenset()
    nearly_all = count + OVER * (best.objective - count)
    for at in leading:
        bounds = at.held_by_belief()
        if bounds and _freed(singles.calibration, at, bounds, nearly_all).objective < nearly_all:
            return bounds
    return frozenset()


def _holding_back(evidence: Evidence) -> frozenset[str]:
    """The prior bounds without which the model found would explain more, or a rival more than it.

    Rivals are asked where more than noise is left: what rests on no bound may lead because another form of its law took
    up what the others may not.
    """
    problem, winner = evidence.calibration.problem, evidence.decision.winner.fit
    rivals = evidence.comparison.entries[:RIVALS] if winner.data > NEAR_NOISE * winner.count else []
    needed = chance_gain(problem.count(), evidence.comparison.residual_variance)
    found: frozenset[str] = frozenset()
    for at in (winner, *(entry.fit for entry in rivals if entry.fit is not winner)):
        bounds = at.held_by_belief()
        if bounds and winner.objective - _freed(evidence.calibration, at, bounds).objective > needed:
            found |= bounds
    return found


def _freed(calibration: Calibration, at: Fit, bounds: frozenset[str], give_up_above: float = inf) -> Fit:
    """A model fitted further without these bounds."""
    rows = calibration.shooting.composition.place_rows
    free = [
        not_believed(parameter, rows[base_name(parameter.name)]) if base_name(parameter.name) in bounds else parameter
        for parameter in at.free
    ]
    return fit(calibration.problem, at.values, free, at.states, iterations=BEYOND, give_up_above=give_up_above)


def _calibrated(
    recordings: Sequence[Recording],
    model: NominalModel,
    progress: Progress,
    calibrated: Callable[[Sequence[Observation], NominalModel], Calibration] = calibrate_finely_enough,
) -> tuple[NominalModel, tuple[Observation, ...], Calibration]:
    """The recordings read and aligned, and the nominal equations calibrated; the model with a stroke that suffices."""
    progress("reading and aligning")
    seen = [observe(recording, model.composition) for recording in recordings]
    check_alike(seen)
    for number, observation in enumerate(seen):
        seen[number], model = with_sufficient_stroke(observation, model)
    progress("calibrating the nominal equations")
    observations, calibration = calibrate_but_for_the_ends(seen, model, calibrated)
    return model, observations, calibration


def _single_effects(recordings: Sequence[Recording], model: NominalModel, progress: Progress) -> _Singles:
    model, observations, calibration = _calibrated(recordings, model, progress)
    scales = characteristic_scales(observations, calibration.shooting, calibration.fitted)
    applicable = applicable_effects(observations)
    comparison = compete(calibration.problem, calibration.fitted, applicable, scales, progress)
    return _Singles(model.values, observations, calibration, scales, applicable, comparison)


def _with_sets(singles: _Singles, progress: Progress) -> Evidence:
    observations, scales = singles.observations, singles.scales
    shooting, fitted = singles.calibration.shooting, singles.calibration.fitted
    lead = telling_most(shooting, fitted)
    alternatives = _equations(observations, lead, singles.calibration)
    calibration, stepwise = with_sets(singles.calibration, singles.comparison, singles.applicable, scales, progress)
    comparison = _as_sets(stepwise)
    return _decided(observations, lead, singles.nominal, calibration, scales, alternatives, comparison, progress)


def _over_whole_sets(recordings: Sequence[Recording], model: NominalModel, progress: Progress) -> Evidence:
    """The same stages with the search over whole sets."""
    model, observations, calibration = _calibrated(recordings, model, progress, calibrate)
    shooting, fitted = calibration.shooting, calibration.fitted
    scales = characteristic_scales(observations, shooting, fitted)
    lead = telling_most(shooting, fitted)
    alternatives = _equations(observations, lead, calibration)
    calibration, comparison = find_sets(observations, calibration, applicable_effects(observations), scales, progress)
    if calibration.shooting.step_size != shooting.step_size:
        scales = characteristic_scales(observations, calibration.shooting, calibration.fitted)
    return _decided(observations, lead, model.values, calibration, scales, alternatives, comparison, progress)


def _equations(
    observations: Sequence[Observation], lead: int, calibration: Calibration
) -> tuple[tuple[EquationResidual, ...], ...]:
    """What the equations of the leading recording lack under the calibrated model, and under the nominal one."""
    shooting = calibration.shooting
    return tuple(
        equation_residuals(observations[lead - 1], recording_alone(shooting, lead), fit_alone(shooting, result, lead))
        for result in (calibration.fitted, calibration.nominal)
    )


def _decided(
    observations: tuple[Observation, ...],
    lead: int,
    nominal: Mapping[str, float],
    calibration: Calibration,
    scales: Scales,
    alternatives: tuple[tuple[EquationResidual, ...], ...],
    comparison: ModelComparison,
    progress: Progress,
) -> Evidence:
    """The evidence with the decision that a comparison leads to."""
    recovery = recover(calibration.problem, comparison, scales, progress)
    decision = decide(calibration, nominal, comparison, recovery)
    location = attribute(calibration, comparison.nominal.fit, scales, comparison, lead)
    return Evidence(
        observations, lead, nominal, calibration, scales, smallest(alternatives), alternatives, comparison, recovery,
        decision, location,
    )  # fmt: skip


def _as_sets(stepwise: SinglesAndSets) -> ModelComparison:
    """The comparison of single effects and sets, as what follows knows it."""
    entries = tuple(Entry(one.hypothesis, one.fit, one.score, one.cost) for one in stepwise.entries)
    nominal = Entry(stepwise.nominal.hypothesis, stepwise.nominal.fit, stepwise.nominal.score)
    return ModelComparison(
        nominal, entries, stepwise.residual_variance, site_gains(stepwise), stepwise.left_over,
        cut_short=stepwise.cut_short,
    )  # fmt: skip


def diagnose(
    recording: Recording, nominal: Mapping[str, float] | NominalModel, progress: Progress = lambda _: None
) -> Diagnosis:
    """Say whether the nominal plant explains the recording, and what it leaves out if it does not."""
    return diagnose_together([recording], nominal, progress)


def diagnose_together(
    recordings: Sequence[Recording],
    nominal: Mapping[str, float] | NominalModel,
    progress: Progress = lambda _: None,
    jobs: int = 2,
    tests: Sequence[Recording] = (),
    search: str = SEARCHES[0],
) -> Diagnosis:
    """The verdict on recordings of one rig, fitted with one set of parameters and effects.

    Args:
        recordings: of the same rig; the report draws the one of which the nominal equations leave most unexplained.
        nominal: every parameter of the model, and which are unknown or have a value of their own in each recording.
        progress: receives each stage as it begins.
        jobs: threads that simulate side by side.
        tests: recordings that nothing is fitted to; the result says how well they are predicted.
        search: how effects are found, one of SEARCHES.

    Raises:
        RecordingError: a recording cannot be used, or they are driven by different channels.
    """
    # the simulations share the cores; a linear-algebra library that spins threads of its own only takes them away
    with threadpool_limits(1), side_by_side(jobs):
        model = nominal if isinstance(nominal, NominalModel) else NominalModel(nominal)
        evidence = examine(recordings, model, progress, search)
        return conclude(recordings, evidence, progress, tests)
