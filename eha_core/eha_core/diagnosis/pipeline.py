"""`diagnose`: the stages in their order, from recordings of a rig to a frozen result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from threadpoolctl import threadpool_limits

from eha_core.diagnosis.attribution import attribute
from eha_core.diagnosis.calibrate import Calibration, calibrate_without_faulty_ends
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.conclude import conclude
from eha_core.diagnosis.doubtful_command import without_doubtful_command
from eha_core.diagnosis.evidence import Evidence, recording_with_largest_residual
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.diagnosis.result import Diagnosis
from eha_core.diagnosis.search.columns import applicable_effects
from eha_core.diagnosis.search.course import find_sets
from eha_core.diagnosis.search.pool import Progress
from eha_core.diagnosis.unknown import recover
from eha_core.diagnosis.verdict import decide
from eha_core.identification.observation import Observation, observe, with_sufficient_stroke
from eha_core.identification.parallel import side_by_side
from eha_core.identification.together import check_alike, fit_alone, recording_alone
from eha_core.nominal import NominalModel
from eha_core.recording import Recording
from eha_core.weak_form.equation_residuals import EquationResidual, equation_residuals, smallest


def examine(recordings: Sequence[Recording], model: NominalModel, progress: Progress = lambda _: None) -> Evidence:
    """Run the stages up to the decision. Raises RecordingError where a recording cannot be used."""
    model, observations, calibration = _calibrated(recordings, model, progress)
    shooting, fitted = calibration.shooting, calibration.fitted
    scales = characteristic_scales(observations, shooting, fitted)
    lead = recording_with_largest_residual(shooting, fitted)
    alternatives = _equations(observations, lead, calibration)
    calibration, comparison = find_sets(observations, calibration, applicable_effects(observations), scales, progress)
    if calibration.shooting.step_size != shooting.step_size:
        scales = characteristic_scales(observations, calibration.shooting, calibration.fitted)
    recovery = recover(calibration.problem, comparison, scales, progress)
    decision = decide(calibration, model.values, comparison, recovery)
    location = attribute(calibration, comparison.nominal.fit, scales, comparison, lead)
    return Evidence(
        observations, lead, model.values, calibration, scales, smallest(alternatives), alternatives, comparison,
        recovery, decision, location,
    )  # fmt: skip


def _calibrated(
    recordings: Sequence[Recording], model: NominalModel, progress: Progress
) -> tuple[NominalModel, tuple[Observation, ...], Calibration]:
    """The nominal model, with a sufficient stroke, the observations of the recordings, and the calibration."""
    progress("reading and aligning")
    seen = [observe(recording, model.composition) for recording in recordings]
    check_alike(seen)
    for number, observation in enumerate(seen):
        seen[number], model = with_sufficient_stroke(observation, model)
    progress("calibrating the nominal equations")
    observations, calibration = calibrate_without_faulty_ends(seen, model)
    return model, *(without_doubtful_command(recordings, seen, calibration, model) or (observations, calibration))


def _equations(
    observations: Sequence[Observation], lead: int, calibration: Calibration
) -> tuple[tuple[EquationResidual, ...], ...]:
    """The equation residuals of the lead recording under the recalibrated and under the nominal model."""
    shooting = calibration.shooting
    return tuple(
        equation_residuals(observations[lead - 1], recording_alone(shooting, lead), fit_alone(shooting, result, lead))
        for result in (calibration.fitted, calibration.nominal)
    )


def diagnose(
    recording: Recording, nominal: Mapping[str, float] | NominalModel, progress: Progress = lambda _: None
) -> Diagnosis:
    """Diagnose whether the nominal plant explains the recording and, if not, which physics is missing."""
    return diagnose_together([recording], nominal, progress)


def diagnose_together(
    recordings: Sequence[Recording],
    nominal: Mapping[str, float] | NominalModel,
    progress: Progress = lambda _: None,
    jobs: int = 2,
    tests: Sequence[Recording] = (),
    limits: Limits | None = None,
) -> Diagnosis:
    """The verdict on recordings of one rig, fitted with one set of parameters and effects.

    Args:
        recordings: of the same rig; the report shows the one with the largest residual of the recalibrated model.
        nominal: every parameter of the model, and which are unknown or have a value of their own in each recording.
        progress: receives each stage as it begins.
        jobs: threads that simulate in parallel.
        tests: recordings that nothing is fitted to; the result says how well they are predicted.
        limits: those of the proposed test; by default the model's own.

    Raises:
        RecordingError: a recording cannot be used, or they are driven by different channels.
    """
    # the simulations use all cores; threads of the linear-algebra library would only compete for them
    with threadpool_limits(1), side_by_side(jobs):
        model = nominal if isinstance(nominal, NominalModel) else NominalModel(nominal)
        evidence = examine(recordings, model, progress)
        return conclude(recordings, evidence, progress, tests, limits)
