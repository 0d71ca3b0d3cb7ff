"""Stage 7, next experiment: the voltage test whose outcome would distinguish rival explanations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.criteria import CHANCE
from eha_core.diagnosis.experiment.command_signal import CommandSignal
from eha_core.diagnosis.experiment.discrimination import STEP, separation
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.diagnosis.result import Experiment
from eha_core.effects import effect_title
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array

DURATIONS = (10.0, 20.0, 40.0, 60.0)
"""s; possible durations of a test. All trials are compared at the first; if that is too short, LASTING of them at the
duration that suffices, because the separation grows with it."""

LASTING = 3

FAINTEST = 1e-4
"""V; below this there is no test."""

DIGITS = 3
"""Significant digits of a proposed amplitude."""

MOST_RIVALS = 5
"""Most rivals of the winner that a test is designed for."""

LEVELS = 5
GENTLEST = 0.25
"""How many amplitudes are tried, from this share of the voltage used so far up to the valve's saturation."""

TELLING = 100.0
"""Chi^2 by which a test has to separate the rivals: it scatters by about 2 sqrt(chi^2), and ten are needed to name one.
Below CHANCE it hardly separates them."""

PRESSURES = {"pressure_a": 1e4, "pressure_b": 1e4}
"""Channels to add where a voltage alone does not suffice, and the assumed noise of their sensors [Pa]."""

Rival = tuple[tuple[str, ...], Fit]


@dataclass(frozen=True)
class Discrimination:
    """A trial of some duration [s], and the chi^2 by which it separates the two rivals hardest to distinguish."""

    trial: CommandSignal
    duration: float
    separation: float


def trials(level: float, limit: float) -> Iterator[CommandSignal]:
    """Tests from a gentle share of the voltage used so far up to the limit [V], slow to fast."""
    for exact in np.geomspace(min(GENTLEST * level, limit), limit, LEVELS).tolist():
        amplitude = float(f"{exact:.{DIGITS}g}")
        for frequency in (0.3, 1.0, 3.0, 8.0):
            yield CommandSignal("sine", {"amplitude": amplitude, "frequency": frequency})
        yield CommandSignal(
            "chirp", {"amplitude": amplitude, "start_frequency": 0.2, "end_frequency": 12.0, "duration": DURATIONS[0]}
        )
        for period in (0.4, 1.5, 4.0):
            yield CommandSignal("square", {"amplitude": amplitude, "frequency": 1.0 / period})
        yield CommandSignal("prbs", {"amplitude": amplitude})
        yield CommandSignal("multisine", {"amplitude": amplitude})


def _times(duration: float) -> Array:
    """The times at which a test's voltage changes: one per STEP [s]."""
    return np.asarray(np.arange(round(duration / STEP)) * STEP, dtype=np.float64)


def propose(
    rivals: Sequence[Rival], noises: Mapping[str, float], level: float, voltage_limit: float,
    limits: Limits | None = None,
) -> Experiment:  # fmt: skip
    """The shortest trial that separates all pairs of rivals within the rig's stroke, pressures and voltage; or the one
    that comes closest.

    Where no voltage separates them in the recorded channels, the pressures are to be recorded, too. `noises` are the
    channels' [their unit] at RATE samples per second, `level` is the voltage used so far and `voltage_limit` the
    largest [V]. `limits`: the rig's, by default those of a rig with a rival's values.
    """
    names = [ids for ids, _ in rivals[: MOST_RIVALS + 1]]
    fits = [result for _, result in rivals[: MOST_RIVALS + 1]]
    record: tuple[str, ...] = ()
    best = _best_discrimination(fits, noises, level, voltage_limit, limits)
    if best.separation < TELLING and not set(PRESSURES) <= set(noises):
        record = tuple(name for name in PRESSURES if name not in noises)
        best = _best_discrimination(fits, {**PRESSURES, **noises}, level, voltage_limit, limits)
    beside = ", with the chambers' pressures recorded too," if record else ""
    verb = "should tell" if best.separation > TELLING else "may tell" if best.separation > CHANCE else "hardly tells"
    statement = (
        f"{_titles(names)}: a {best.trial.signal} of voltage ({best.trial.settings()})"
        f" for {best.duration:g} s{beside} {verb} them apart"
        f" (expected: {np.sqrt(best.separation):.0f} deviations of noise)"
    )
    separates = tuple(dict.fromkeys(name for ids in names for name in ids))
    return Experiment(statement, separates, best.trial.reference(), record, best.duration, best.separation)


def not_proposed(names: Sequence[tuple[str, ...]], driving: Sequence[str], source: str) -> Experiment:
    """The result where no voltage drives the rig: why no test is proposed, and what may distinguish the rivals."""
    statement = (
        f"{_titles(names)}: no signal is proposed, as {' and '.join(driving)} of"
        f" {source} come from the rig and not from the reference generator; record slower and faster reversals than"
        " these, and diagnose both recordings together"
    )
    return Experiment(statement, tuple(dict.fromkeys(name for ids in names for name in ids)), {})


def _titles(rivals: Sequence[tuple[str, ...]]) -> str:
    return " or ".join(" and ".join(map(effect_title, ids)) for ids in rivals)


def _best_discrimination(
    rivals: Sequence[Fit], noises: Mapping[str, float], level: float, voltage_limit: float, limits: Limits | None
) -> Discrimination:
    """The shortest trial that separates the rivals, or else the one that separates them most."""
    short = DURATIONS[0]
    discriminations: list[Discrimination] = []
    while not discriminations and voltage_limit > FAINTEST:
        for trial in trials(level, voltage_limit):
            separated = separation(trial.voltage(_times(short)), rivals, noises, limits)
            if separated is not None:
                discriminations.append(Discrimination(trial, short, separated))
        voltage_limit = min(GENTLEST * level, voltage_limit)  # smaller ones, where none stays within the limits
        level = GENTLEST * voltage_limit
    if not discriminations:
        return Discrimination(CommandSignal("sine", {"amplitude": 0.0, "frequency": 1.0}), short, 0.0)
    leading = sorted(discriminations, key=lambda discrimination: -discrimination.separation)[:LASTING]
    best = leading[0]
    if best.separation < TELLING:
        lasting = [_lasting(discrimination, rivals, noises, limits) for discrimination in leading]
        best = max([best, *lasting], key=lambda discrimination: discrimination.separation)
    return best


def _lasting(
    discrimination: Discrimination, rivals: Sequence[Fit], noises: Mapping[str, float], limits: Limits | None
) -> Discrimination:
    """The same trial with a sufficient duration, if it stays within the limits."""
    per_second = discrimination.separation / discrimination.duration
    duration = next((seconds for seconds in DURATIONS if seconds * per_second > TELLING), DURATIONS[-1])
    separated = separation(discrimination.trial.voltage(_times(duration)), rivals, noises, limits)
    return discrimination if separated is None else Discrimination(discrimination.trial, duration, separated)
