"""The result of a law of given motion, in the form that every diagnosis has."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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
)
from eha_core.motion_given.law import Law, Regression, Value, predict
from eha_core.motion_given.motion import Array, Motion, motion_of
from eha_core.motion_given.search import NOISE_REACHED, find_law, worth_of
from eha_core.quantities import quantity
from eha_core.recording import Recording

NEAR_REVERSAL = 0.2
"""Share of the largest speed below which a motion is near a reversal (assumed)."""

NOT_EXAMINED = "coil, spool, valve flow and chambers: nothing that drives the plant was recorded"
SAME = (
    "beside dry friction, a steady load and a dry friction that differs by direction are one law: given motion cannot"
    " tell them apart"
)


@dataclass(frozen=True)
class Found:
    """A diagnosis, with the law and the motions that it was found on."""

    diagnosis: Diagnosis
    law: Law
    motions: tuple[Motion, ...]


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
    law = find_law(motions, progress)
    fits = ChannelFit(*_errors(motions, law), float(np.sqrt(np.mean([motion.noise**2 for motion in motions]))))
    effects = _effects(motions, law)
    first = recordings[0]
    left = law.share_left
    explained = Explained(
        1.0 - left**2, {"force": fits.rmse_after / fits.noise}, fits.rmse_after < NOISE_REACHED * fits.noise,
        (_left_over(motions, law),),
    )  # fmt: skip
    remarks = [remark for recording in recordings for remark in recording.remarks]
    if {"coulomb_friction", "stribeck_friction", "bouc_wen_friction"} & set(law.ids):
        remarks.append(SAME)
    found = Diagnosis(
        path=str(first.path),
        duration=sum(recording.duration for recording in recordings),
        channels=tuple(first.channels),
        not_examined=(NOT_EXAMINED,),
        remarks=tuple(remarks),
        damaged=first.damaged,
        verdict="missing_physics" if effects else "unknown_physics",
        summary=_summary(effects, explained, fits, law, motions),
        location=(Location("force", 1.0, "everywhere", (), alone=True),),
        parameters=(),
        effects=effects,
        alternatives=(),
        unknown=None,
        training={"force": fits},
        held_out={"force": _predicted(motions, law, tuple(motion_of(test, areas) for test in tests))} if tests else {},
        next_experiment=None,
        rivals=(),
        whiteness={},
        fitted_values={},
        pictures=Pictures({}, {}, {}, {}, {}),
        start_stamp=first.start_stamp,
        explained=explained,
    )
    return Found(found, law, motions)


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
    noise = float(np.sqrt(np.mean([m.noise**2 for m in tests])))
    about_mean, about_line, about_law = (
        float(np.sqrt(np.mean(residual**2))) for residual in (force - force.mean(), straight, left)
    )
    return ChannelFit(about_mean, about_line, about_law, noise)


def _joined(motions: Sequence[Motion]) -> tuple[Array, Array]:
    """Speed and force of all motions, one after the other."""
    speed = np.concatenate([motion.velocity[motion.used] for motion in motions])
    return speed, np.concatenate([motion.force[motion.used] for motion in motions])


def _effects(motions: Sequence[Motion], law: Law) -> tuple[NamedEffect, ...]:
    worth = worth_of(motions, law)
    return tuple(
        NamedEffect(
            id=term.id,
            site="sensor" if term.kind == "smoothing" else "force",
            equation=f"F = ... + {term.equation}",
            parameters={
                name: FittedValue(value.value, value.std, value.unit) for name, value in law.values[term.id].items()
            },
            evidence=worth[term.id],
            statement=term.statement.format(**_told(law.values[term.id])),
            kind=term.kind,
        )
        for term in law.terms
    )


def _told(values: Mapping[str, Value]) -> dict[str, str]:
    """Each value with its unit, as a sentence says it."""
    return {name: quantity(value.value, value.unit, 4) for name, value in values.items()}


def _left_over(motions: Sequence[Motion], law: Law) -> Location:
    """Whether the residual is largest near the reversals or in motion."""
    near, all_of_it, shares = 0.0, 0.0, 0.0
    for motion in motions:
        square = (predict(law, motion) - motion.force)[motion.used] ** 2
        slow = np.abs(motion.velocity[motion.used]) < NEAR_REVERSAL * np.max(np.abs(motion.velocity))
        near, all_of_it = near + float(square[slow].sum()), all_of_it + float(square.sum())
        shares += float(slow.mean()) / len(motions)
    share = near / all_of_it if all_of_it > 0.0 else 0.0
    text = f"{100 * share:.0f} % of the residual is near the reversals, where {100 * shares:.0f} % of the samples are"
    return Location("force", share, text, ())


def _summary(
    effects: Sequence[NamedEffect], explained: Explained, fits: ChannelFit, law: Law, motions: Sequence[Motion]
) -> str:
    if not effects:
        return f"Motion given: no term explains the force, which varies by {fits.rmse_before:.4g} N"
    statements = "; ".join(effect.statement for effect in effects)
    left = f"{fits.rmse_after:.3g} N RMS is left"
    noise = ", which is noise" if explained.complete else f", {explained.times_noise['force']:.3g} times the noise"
    return (
        f"Motion given, the force is explained but for {100 * law.share_left:.1f} % of its deviation: {statements}."
        f" {left}{noise}; {explained.left_over[0].where}"
    )


def curve(law: Law, motion: Motion) -> tuple[Array, Array]:
    """The law's force over a motion, and what the recording has beyond it [N]."""
    force = predict(law, motion)
    return force, motion.force - force
