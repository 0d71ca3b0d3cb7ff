"""The result of a law of given motion, in the form that every diagnosis has."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.result import (
    ChannelFit,
    Diagnosis,
    Explained,
    FittedValue,
    Location,
    NamedEffect,
    Pictures,
    PredictedRecording,
    Prediction,
)
from eha_core.motion_given.law import Law, Regression, predict
from eha_core.motion_given.motion import Array, Motion, motion_of, noise_of
from eha_core.motion_given.recorded import averaging, possible_timing
from eha_core.motion_given.schedule import schedule_remarks
from eha_core.motion_given.search import NOISE_REACHED, find_law, worth_of
from eha_core.motion_given.sentences import Sentences, near_reversals, sentences_of, statement_of
from eha_core.motion_given.unmapped import unmapped_columns
from eha_core.recording import Recording

NOT_EXAMINED = "coil, spool, valve flow and chambers: nothing that drives the plant was recorded"
SAME = (
    "beside dry friction, a steady load and a dry friction that differs by direction are one law: given motion cannot"
    " tell them apart"
)


@dataclass(frozen=True)
class Found:
    """A diagnosis, with the law, the motions that it was found on, and what it says of them."""

    diagnosis: Diagnosis
    law: Law
    motions: tuple[Motion, ...]
    sentences: Sentences


def diagnose_motion(
    recordings: Sequence[Recording],
    progress: Callable[[str], None] = lambda _: None,
    tests: Sequence[Recording] = (),
    areas: tuple[float, float] | None = None,
) -> Found:
    """Find the law of recordings of one rig whose motion is given, and predict the force of the `tests`.

    `areas` of chambers A and B [m^2] make a force of both pressures, where no force was recorded.

    Raises:
        RecordingError: a recording has no force or no motion.
    """
    motions = tuple(motion_of(recording, areas) for recording in recordings)
    tested = tuple(motion_of(test, areas) for test in tests)
    law = find_law(motions, progress)
    noise = noise_of(motions)
    fits = ChannelFit(*_errors(motions, law), float("nan") if noise is None else noise)
    recorded = averaging(motions, law)
    effects = (*_effects(motions, law), *([recorded] if recorded else []))
    sentences = sentences_of(motions, law, [effect.statement for effect in effects])
    first = recordings[0]
    found = Diagnosis(
        path=str(first.path),
        duration=sum(recording.duration for recording in recordings),
        channels=tuple(first.channels),
        not_examined=(NOT_EXAMINED,),
        remarks=tuple(dict.fromkeys(_remarks(recordings, tests, motions, tested, law))),
        damaged=first.damaged,
        verdict="missing_physics" if law.terms else "unknown_physics",
        summary=str(sentences),
        location=(Location("force", 1.0, "everywhere", (), alone=True),),
        parameters=(),
        effects=effects,
        alternatives=(),
        unknown=None,
        training={"force": fits},
        held_out={"force": _predicted(motions, law, tested)} if tests else {},
        tests=tuple(_tested(test, _predicted(motions, law, [motion]))
                    for test, motion in zip(tests, tested, strict=True)),
        next_experiment=None,
        rivals=(),
        whiteness={},
        fitted_values={},
        pictures=Pictures({}, {}, {}, {}, {}),
        start_stamp=first.start_stamp,
        explained=_explained(motions, law, noise),
    )  # fmt: skip
    return Found(found, law, motions, sentences)


def _explained(motions: Sequence[Motion], law: Law, noise: float | None) -> Explained:
    share, samples = near_reversals(motions, law)
    text = f"{100 * share:.0f} % of the residual is near the reversals, where {100 * samples:.0f} % of the samples are"
    ratio = {} if noise is None else {"force": law.error / noise}
    complete = noise is not None and law.error < NOISE_REACHED * noise
    return Explained(1.0 - law.share_left**2, ratio, complete, (Location("force", share, text, ()),))


def _remarks(
    recordings: Sequence[Recording],
    tests: Sequence[Recording],
    motions: Sequence[Motion],
    tested: Sequence[Motion],
    law: Law,
) -> Iterator[str]:
    for recording in (*recordings, *tests):
        yield from recording.remarks
    if {"coulomb_friction", "stribeck_friction", "bouc_wen_friction"} & set(law.ids):
        yield SAME
    yield from possible_timing(motions, law)
    yield from schedule_remarks(motions, tested, law.terms)
    yield from unmapped_columns(recordings, motions, law)


def _tested(test: Recording, fit: ChannelFit) -> PredictedRecording:
    errors = {"nominal": fit.rmse_before, "recalibrated": fit.rmse_calibrated, "augmented": fit.rmse_after}
    predicted = {model: {"force": Prediction({}, error)} for model, error in errors.items()}
    return PredictedRecording(str(test.path), predicted, {"force": fit.noise})


def _errors(motions: Sequence[Motion], law: Law) -> tuple[float, float, float]:
    """RMS [N] of the force about its mean, about straight viscous friction with a load, and about the law."""
    regression = Regression.of(motions)
    force = regression.force
    speed = np.concatenate([m.velocity[rows] for m, rows in zip(regression.motions, regression.rows, strict=True)])
    straight = np.polyval(np.polyfit(speed, force, 1), speed)
    return float(np.std(force)), float(np.sqrt(np.mean((force - straight) ** 2))), law.error


def _predicted(motions: Sequence[Motion], law: Law, tests: Sequence[Motion]) -> ChannelFit:
    """RMS [N] of the tests' force about its mean, about the line of the fitted recordings, and about their law."""
    speed, force = _joined(motions)
    line = np.polyfit(speed, force, 1)
    speed, force = _joined(tests)
    left = np.concatenate([(predict(law, m) - m.force)[m.used] for m in tests])
    straight = force - np.polyval(line, speed)
    noise = noise_of(tests)
    about_mean, about_line, about_law = (
        float(np.sqrt(np.mean(residual**2))) for residual in (force - force.mean(), straight, left)
    )
    return ChannelFit(about_mean, about_line, about_law, float("nan") if noise is None else noise)


def _joined(motions: Sequence[Motion]) -> tuple[Array, Array]:
    """Speed and force of all motions, one after the other."""
    speed = np.concatenate([motion.velocity[motion.used] for motion in motions])
    return speed, np.concatenate([motion.force[motion.used] for motion in motions])


def _effects(motions: Sequence[Motion], law: Law) -> tuple[NamedEffect, ...]:
    worth = worth_of(motions, law)
    return tuple(
        NamedEffect(
            id=term.id,
            site="force",
            equation=f"F = ... + {term.equation}",
            parameters={
                name: FittedValue(value.value, value.std, value.unit) for name, value in law.values[term.id].items()
            },
            evidence=worth[term.id],
            statement=statement_of(term, law.values[term.id]),
            kind=term.kind,
        )
        for term in law.terms
    )


def curve(law: Law, motion: Motion) -> tuple[Array, Array]:
    """The law's force over a motion, and what the recording has beyond it [N]."""
    force = predict(law, motion)
    return force, motion.force - force
