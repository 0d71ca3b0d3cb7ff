"""What a law of given motion says, in sentences: what is certain, what remains, and what to record next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.motion_given.law import Law, Value, predict
from eha_core.motion_given.motion import Motion, noise_of
from eha_core.motion_given.search import NOISE_REACHED
from eha_core.motion_given.terms import Term
from eha_core.quantities import quantity

NEAR_REVERSAL = 0.2
"""Share of the largest speed below which a motion is near a reversal (assumed)."""

ONE_FREQUENCY = 0.05
"""Share by which the periods of single sines differ at most, for them to be one frequency (assumed)."""

SINE = 0.9
"""Correlation of position and acceleration from which on a motion is a sine, on which a spring and a mass are one law;
measured sines have 0.97 to 0.99 (assumed)."""


@dataclass(frozen=True)
class Sentences:
    """One sentence on each: what is certain, what remains, and what to record next.

    `explained` says how much the law explains, `parts` what each of its parts is.
    """

    explained: str
    parts: tuple[str, ...]
    remains: str
    next_recording: str

    @property
    def certain(self) -> str:
        """How much the law explains, and its parts."""
        return f"{self.explained}: {'; '.join(self.parts)}" if self.parts else self.explained

    def __str__(self) -> str:
        return f"{self.certain}. {self.remains}. {self.next_recording}"


def sentences_of(motions: Sequence[Motion], law: Law, statements: Sequence[str]) -> Sentences:
    """The sentences on a law whose effects have these statements."""
    left = f"{100 * law.share_left:.1f} %"
    if not law.terms:
        varies = float(np.std(np.concatenate([motion.force[motion.used] for motion in motions])))
        explained = f"Motion given, no term explains the force, which varies by {varies:.4g} N"
    elif law.holds:
        explained = f"Motion given, the force is explained but for {left} of its deviation"
    else:
        all_of_them = " for all recordings" if len(motions) > 1 else ""
        explained = (
            f"Motion given, no law was found that holds{all_of_them}; the best leaves {left} of the force's deviation,"
            " with these parts"
        )
    return Sentences(explained, tuple(statements) if law.terms else (), _remains(motions, law), _next(motions, law))


def statement_of(term: Term, values: Mapping[str, Value]) -> str:
    """What a term says, with its values; those that depend on the schedule at each of its levels."""
    shown = {name: quantity(value.value, value.unit, 4) for name, value in values.items()}
    if not term.levels:
        return term.statement.format(**shown)
    courses = []
    for name in dict.fromkeys(size.partition(" at ")[0] for size, _ in term.sizes):
        sizes = [f"{name} at {level:g}" for level in term.levels]
        *first, last = (f"{shown[size]} at {level:g}" for size, level in zip(sizes, term.levels, strict=True))
        shown[name] = f"{', '.join(first)} and {last}"
        courses.append(f"{name} {_course([values[size].value for size in sizes])} with {term.schedule}")
    return f"{term.statement.format(**shown)}; {' and '.join(courses)}"


def _course(values: Sequence[float]) -> str:
    steps = np.diff(values)
    return "grows" if np.all(steps > 0.0) else "falls" if np.all(steps < 0.0) else "changes"


def near_reversals(motions: Sequence[Motion], law: Law) -> tuple[float, float]:
    """The shares of the squared residual and of the samples that are near a reversal of the motion."""
    near, whole, samples = 0.0, 0.0, 0.0
    for motion in motions:
        square = (predict(law, motion) - motion.force)[motion.used] ** 2
        slow = np.abs(motion.velocity[motion.used]) < NEAR_REVERSAL * np.max(np.abs(motion.velocity))
        near, whole = near + float(square[slow].sum()), whole + float(square.sum())
        samples += float(slow.mean()) / len(motions)
    return near / whole if whole > 0.0 else 0.0, samples


def _remains(motions: Sequence[Motion], law: Law) -> str:
    noise = noise_of(motions)
    if noise is None:
        against = "; how much of it is noise is not known, because the recorded force was averaged"
    elif law.error < NOISE_REACHED * noise:
        return f"What remains, {law.error:.3g} N RMS, is noise"
    else:
        against = f", {law.error / noise:.3g} times the noise"
    share, samples = near_reversals(motions, law)
    return (
        f"What remains is {law.error:.3g} N RMS{against}; {100 * share:.0f} % of its square is near the reversals,"
        f" where {100 * samples:.0f} % of the samples are"
    )


def _next(motions: Sequence[Motion], law: Law) -> str:
    """The one recording that would add most."""
    if len(motions) > 1 and not law.holds and all(motion.schedule is None for motion in motions):
        return "Record what was changed between the recordings and map it as schedule: one law does not hold for all"
    if any(motion.averaged is not None for motion in motions):
        return "Record the force as the sensor gives it: an average hides its noise and its reversals"
    periods = [motion.period for motion in motions if motion.period is not None and _is_sine(motion)]
    if len(periods) == len(motions) and max(periods) - min(periods) < ONE_FREQUENCY * max(periods):
        return (
            "Record another frequency: at one frequency a spring and a mass are one law, and a delay and compliance"
            " are hard to distinguish"
        )
    if near_reversals(motions, law)[0] > 0.5:
        return "Record slow reversals of the motion: most of what remains is there"
    return "Record a motion of other speeds and strokes, and give it as --test"


def _is_sine(motion: Motion) -> bool:
    return float(np.corrcoef(motion.position, motion.acceleration)[0, 1]) < -SINE
