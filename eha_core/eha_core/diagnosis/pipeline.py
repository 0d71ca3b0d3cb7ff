"""`diagnose`: the stages in their order, from recordings of a rig to a frozen result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from threadpoolctl import threadpool_limits

from eha_core.diagnosis.attribution import attribute
from eha_core.diagnosis.calibrate import calibrate_but_for_the_ends
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.conclude import conclude
from eha_core.diagnosis.criteria import chance_gain
from eha_core.diagnosis.evidence import Evidence, telling_most
from eha_core.diagnosis.result import Diagnosis
from eha_core.diagnosis.search.columns import applicable_effects
from eha_core.diagnosis.search.course import find_sets
from eha_core.diagnosis.search.pool import Progress
from eha_core.diagnosis.unknown import recover
from eha_core.diagnosis.verdict import decide
from eha_core.identification.fit import fit
from eha_core.identification.free_parameters import not_believed
from eha_core.identification.observation import observe, with_sufficient_stroke
from eha_core.identification.parallel import side_by_side
from eha_core.identification.per_recording import base_name
from eha_core.identification.together import check_alike, fit_alone, recording_alone
from eha_core.nominal import NominalModel
from eha_core.recording import Recording
from eha_core.weak_form.equation_residuals import equation_residuals, smallest

BEYOND = 20
"""Iterations of a model without the bounds that it rests on, before the search is repeated without them."""


def examine(recordings: Sequence[Recording], model: NominalModel, progress: Progress = lambda _: None) -> Evidence:
    """Run the stages up to the decision; once more without the prior bounds that the best model rests on.

    How far a nominal value is believed must not decide which physics is named. Raises RecordingError where a recording
    cannot be used.
    """
    evidence = _examine(recordings, model, progress)
    bounds = _limiting(evidence) - model.unknown
    if not bounds:
        return evidence
    progress(f"once more: {', '.join(sorted(bounds))} went as far as its prior bound")
    again = _examine(recordings, replace(model, unknown=model.unknown | bounds), progress)
    gain = evidence.decision.winner.fit.objective - again.decision.winner.fit.objective
    needed = chance_gain(again.calibration.problem.count(), again.comparison.residual_variance)
    return again if gain > needed else evidence


def _limiting(evidence: Evidence) -> frozenset[str]:
    """The prior bounds without which the best model would explain more."""
    at = evidence.decision.winner.fit
    bounds = at.held_by_belief()
    if not bounds:
        return frozenset()
    rows = evidence.calibration.shooting.composition.place_rows
    free = [
        not_believed(parameter, rows[base_name(parameter.name)]) if base_name(parameter.name) in bounds else parameter
        for parameter in at.free
    ]
    freed = fit(evidence.calibration.problem, at.values, free, at.states, iterations=BEYOND)
    needed = chance_gain(evidence.calibration.problem.count(), evidence.comparison.residual_variance)
    return bounds if at.objective - freed.objective > needed else frozenset()


def _examine(recordings: Sequence[Recording], model: NominalModel, progress: Progress) -> Evidence:
    progress("reading and aligning")
    seen = [observe(recording, model.composition) for recording in recordings]
    check_alike(seen)
    for number, observation in enumerate(seen):
        seen[number], model = with_sufficient_stroke(observation, model)
    progress("calibrating the nominal equations")
    observations, calibration = calibrate_but_for_the_ends(seen, model)
    shooting, fitted = calibration.shooting, calibration.fitted
    scales = characteristic_scales(observations, shooting, fitted)
    applicable = applicable_effects(observations)
    lead = telling_most(shooting, fitted)
    alternatives = tuple(
        equation_residuals(observations[lead - 1], recording_alone(shooting, lead), fit_alone(shooting, result, lead))
        for result in (fitted, calibration.nominal)
    )
    calibration, comparison = find_sets(observations, calibration, applicable, scales, progress)
    recovery = recover(calibration.problem, comparison, scales, progress)
    decision = decide(calibration, model.values, comparison, recovery)
    location = attribute(calibration, comparison.nominal.fit, scales, comparison, lead)
    return Evidence(
        observations, lead, model.values, calibration, scales, smallest(alternatives), alternatives, comparison,
        recovery, decision, location,
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
) -> Diagnosis:
    """The verdict on recordings of one rig, fitted with one set of parameters and effects.

    Args:
        recordings: of the same rig; the report draws the one of which the nominal equations leave most unexplained.
        nominal: every parameter of the model, and which are unknown or have a value of their own in each recording.
        progress: is told each stage as it begins.
        jobs: threads that simulate side by side.
        tests: recordings that nothing is fitted to; the result says how well they are predicted.

    Raises:
        RecordingError: a recording cannot be used, or they are driven by different channels.
    """
    # the simulations share the cores; a linear-algebra library that spins threads of its own only takes them away
    with threadpool_limits(1), side_by_side(jobs):
        model = nominal if isinstance(nominal, NominalModel) else NominalModel(nominal)
        evidence = examine(recordings, model, progress)
        return conclude(recordings, evidence, progress, tests)
