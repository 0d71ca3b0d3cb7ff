"""What imitates a concealed effect: the truth without it, its values and the states it starts from changed.

The changes are found by Gauss-Newton steps, each simulated: those that imitate a large effect are too large for one
linearisation. Where oil and piston ring through a window, derivatives lead nowhere at all; for the effect that changes
their frequency, air in the oil, the steps begin at oil that is as soft.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_exam.case import POSITION_NOISE, PRESSURE_NOISE, Case
from eha_exam.errors import ExamError
from eha_exam.truth import resume_truth
from eha_exam.truth.laws import stiffness_of_oil
from eha_exam.truth.record import Effect, neutral_record, with_effect

Array = NDArray[np.float64]

WINDOW = 1.0
"""Length [s] of the windows in which it is asked."""
STEP = 1e-3
"""Relative step of the derivatives."""
TRUST = 0.5
"""Relative standard deviation within which any nominal value is believed."""
LEAST, MOST = -0.9, 1.0
"""Relative changes go no further: none changes its sign, and twice TRUST is believed of none."""
NO_LIMIT = 1e30
"""A parameter as large as this says that the law has no such limit."""
SHIFTS = {"position": 1e-5, "velocity": 1e-3, "pressure_a": 1e4, "pressure_b": 1e4}
"""The states that a window starts from, and the steps of the derivatives by them."""
STEPS = 8
"""Gauss-Newton steps at most. An exact imitation of a 9 % error of a position sensor's scale took three."""
SHARES = (1.0, 0.5, 0.2)
"""Of such a step, one after the other until one imitates better, ..."""
LESS = 0.5
"""... which is to leave less than this share of what was left before: towards an exact imitation each step leaves a
small part of that."""


@dataclass(frozen=True)
class Doubted:
    """The truth with the effects `kept` alone, of which may change, relative to themselves, the nominal parameters
    `names` and then what a diagnosis would have to fit of each kept effect."""

    case: Case
    truth: Mapping[str, Array]
    names: Sequence[str]
    kept: tuple[Effect, ...]

    @property
    def of_effects(self) -> list[tuple[int, str]]:
        """Which parameters of which kept effects may change."""
        return [(place, name) for place, (_, values) in enumerate(self.kept) for name in _doubted(values)]

    @property
    def size(self) -> int:
        """How many values may change."""
        return len(self.names) + len(self.of_effects)

    def recorded(self, first: int) -> Array:
        """The recorded channels over their noise, but without it, in the window from sample `first`."""
        last = first + length(self.case)
        return scaled(self.case, {name: column[first : last + 1] for name, column in self.truth.items()})

    def simulated(self, first: int, changes: Array, shift: Array, more: Sequence[Effect] = ()) -> Array:
        """The same simulated from the true state, shifted by so many of SHIFTS, with the values changed and with `more`
        effects. Raises ExamError where that cannot be integrated."""
        plant = dict(self.case.plant)
        for name, change in zip(self.names, changes[: len(self.names)].tolist(), strict=True):
            plant[name] *= 1.0 + change
        values = [dict(own) for _, own in self.kept]
        for (place, name), change in zip(self.of_effects, changes[len(self.names) :].tolist(), strict=True):
            values[place][name] = float(values[place][name]) * (1.0 + change)
        effects = [(name, own) for (name, _), own in zip(self.kept, values, strict=True)]
        by = {name: step * times for (name, step), times in zip(SHIFTS.items(), shift.tolist(), strict=True)}
        last = first + length(self.case)
        return scaled(self.case, resume_truth(plant, [*effects, *more], self.truth, first, last, shift=by))

    def with_rival(self, first: int, rival: Effect) -> Array:
        """What one effect more, a rival of the one in question, changes there."""
        changes, shift = np.zeros(self.size), np.zeros(len(SHIFTS))
        return self.simulated(first, changes, shift, [rival]) - self.simulated(first, changes, shift)

    def linearised(self, first: int, changes: Array, shift: Array) -> Linearised:
        """What is simulated there, and its derivatives."""
        here = self.simulated(first, changes, shift)
        by_change = [(self.simulated(first, changes + STEP * one, shift) - here) / STEP for one in np.eye(len(changes))]
        by_shift = [self.simulated(first, changes, shift + one) - here for one in np.eye(len(shift))]
        return Linearised(self.recorded(first) - here, np.stack(by_change, axis=1), np.stack(by_shift, axis=1))


@dataclass(frozen=True)
class Linearised:
    """What a simulation of a window leaves of the recording (samples,), and what it would change by: the changes, and
    the shifts of the window's start (samples, ...)."""

    left: Array
    by_change: Array
    by_shift: Array

    def of_any_start(self, columns: Array) -> Array:
        """Columns without what the window's start can imitate of them."""
        basis = np.linalg.qr(self.by_shift)[0]
        free: Array = columns - basis @ (basis.T @ columns)
        return free


@dataclass(frozen=True)
class _Imitation:
    """Changes, shifts (windows, 4), and how far what they give is from the recording."""

    changes: Array
    shifts: Array
    misfit: float


def as_soft(model: Doubted) -> Array:
    """The changes that make up for air that is left out: oil without it, as soft as the mixture is at the mean pressure
    of the chambers. None of them changes anything where no air is left out."""
    changes = np.zeros(model.size)
    pressure = float(np.mean([model.truth["pressure_a"], model.truth["pressure_b"]]))
    for effect in model.case.effects:
        if effect[0] == "entrained_air" and effect not in model.kept:
            mixture = with_effect(neutral_record(model.case.plant), effect)[0]
            ratio = float(stiffness_of_oil(pressure, mixture)) / model.case.plant["bulk_modulus"]
            changes[model.names.index("bulk_modulus")] = np.clip(ratio - 1.0, LEAST, MOST)
    return changes


def left_by_the_best(model: Doubted, starts: Sequence[int], begin: Array, enough: float) -> float:
    """Nats that the best imitation leaves in the windows from the samples `starts`; the search for it begins at the
    changes `begin`, and may leave less where that is less than `enough`."""
    try:
        at = _imitation(model, starts, begin, np.zeros((len(starts), len(SHIFTS))))
    except ExamError:  # no such rig can be integrated
        return np.inf
    for _ in range(STEPS):
        if at.misfit < enough:
            break
        pairs = zip(starts, at.shifts, strict=True)
        try:
            windows = [model.linearised(first, at.changes, shift) for first, shift in pairs]
        except ExamError:  # nor one a little beside it
            break
        better = _better(model, starts, at, *_step(windows, at.changes))
        if better is None:
            break
        at = better
    return at.misfit


def _imitation(model: Doubted, starts: Sequence[int], changes: Array, shifts: Array) -> _Imitation:
    left = [
        model.recorded(first) - model.simulated(first, changes, shift)
        for first, shift in zip(starts, shifts, strict=True)
    ]
    misfit = 0.5 * float(np.sum(np.square(left)) + np.sum((changes / TRUST) ** 2))
    return _Imitation(changes, shifts, misfit)


def _better(model: Doubted, starts: Sequence[int], at: _Imitation, changes: Array, shifts: Array) -> _Imitation | None:
    """The imitation at the largest share of a step that leaves so much less."""
    for share in SHARES:
        try:
            there = np.clip(at.changes + share * changes, LEAST, MOST)
            tried = _imitation(model, starts, there, at.shifts + share * shifts)
        except ExamError:  # no such rig can be integrated
            continue
        if tried.misfit < LESS * at.misfit:
            return tried
    return None


def _step(windows: Sequence[Linearised], changes: Array) -> tuple[Array, Array]:
    """The step to the best imitation by its derivatives: of the changes, and of each window's start."""
    matrix = np.concatenate([np.eye(len(changes)) / TRUST, *(at.of_any_start(at.by_change) for at in windows)])
    left = np.concatenate([-changes / TRUST, *(at.of_any_start(at.left) for at in windows)])
    move: Array = np.linalg.lstsq(matrix, left, rcond=None)[0]
    shifts = np.empty((len(windows), len(SHIFTS)))
    for shift, at in zip(shifts, windows, strict=True):
        shift[:] = np.linalg.lstsq(at.by_shift, at.left - at.by_change @ move, rcond=None)[0]
    return move, shifts


def length(case: Case) -> int:
    """Samples of a window."""
    return round(WINDOW * case.rate)


def scaled(case: Case, columns: Mapping[str, Array]) -> Array:
    """The recorded channels over their noise, one after the other."""
    pieces = [columns["measured_position"] / (case.noise * POSITION_NOISE)]
    for channel in ("pressure_a", "pressure_b"):
        if channel in case.channels:
            pieces.append(columns[f"measured_{channel}"] / (case.noise * PRESSURE_NOISE))
    return np.concatenate(pieces)


def _doubted(values: Mapping[str, object]) -> list[str]:
    """The parameters of an effect that a diagnosis has to fit: its sizes, and the shape of its law."""
    return [name for name, value in values.items() if isinstance(value, float) and 0.0 < abs(value) < NO_LIMIT]
