"""The discrimination of a test: by how much the outcomes predicted by rival explanations differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations

import numpy as np

from eha_core.diagnosis.calibrate import STEPS
from eha_core.diagnosis.experiment.limits import Limits, limits_of
from eha_core.diagnosis.hypothesis import NOMINAL_NAMES
from eha_core.identification.fit import SETTLED, Fit
from eha_core.identification.free_parameters import FreeParameter, coordinates, values_at
from eha_core.identification.numbers import Array
from eha_core.identification.per_recording import is_one_of
from eha_core.plant import COLUMNS, Plant

STEP = STEPS[0]
ROWS_EVERY = 5
RATE = 1.0 / (STEP * ROWS_EVERY)
"""Hz; rate of the samples that are compared."""

MOVES = 6
"""Most steps of a rival's parameters to compensate for another's outcome; the residual is nearly linear in them."""

NUDGE = 1e-3
"""Finite difference of a parameter's coordinate."""


def separation(
    voltage: Array, rivals: Sequence[Fit], noises: Mapping[str, float], limits: Limits | None = None
) -> float | None:
    """Least chi^2 between any two rivals' outcomes of a test, after their parameters were fitted to each other.

    The voltage [V] has one value per STEP, for whole seconds; `noises` are the channels' [their unit] at RATE samples
    per second. None where the test exceeds the limits under one of the rivals: `limits`, or else those of a rig with
    the rival's values.
    """
    test = _Test(voltage, noises)
    responses = [test.respond(rival.values) for rival in rivals]
    if not all(_is_bearable(rows, rival.values, limits) for rows, rival in zip(responses, rivals, strict=True)):
        return None
    outcomes = [test.measured(rows) for rows in responses]
    first = rivals[0]
    nominal = tuple(parameter for parameter in first.free if is_one_of(parameter.name, NOMINAL_NAMES))
    shared = test.slopes(first, nominal, outcomes[0])
    near, every = [], []
    for rival, outcome in zip(rivals, outcomes, strict=True):
        own = tuple(parameter for parameter in rival.free if not is_one_of(parameter.name, NOMINAL_NAMES))
        slopes = _Slopes(nominal + own, np.hstack([shared, test.slopes(rival, own, outcome)]))
        every.append(slopes)
        near.append(outcome if rival is first else _imitating(outcomes[0], test, rival, slopes, outcome))
    pairs = permutations(range(len(rivals)), 2)
    return min(every[one].left_of(near[other] - near[one]) for one, other in pairs)


@dataclass(frozen=True)
class _Test:
    """A voltage [V], one value a STEP, and the noise of the channels that record what it does."""

    voltage: Array
    noises: Mapping[str, float]

    def respond(self, values: Mapping[str, float]) -> Array:
        """The plant's rows, all its columns."""
        return Plant(values, STEP).run(self.voltage, ROWS_EVERY).values

    def measured(self, rows: Array) -> Array:
        """The measured channels in units of their noise, one after the other; the position without its mean in each
        second, because a fit has an initial state there and learns little from a drift."""
        pieces = {name: rows[:, COLUMNS.index(f"measured_{name}")] / noise for name, noise in self.noises.items()}
        if "position" in pieces:
            seconds = pieces["position"].reshape(-1, round(RATE))
            pieces["position"] = (seconds - seconds.mean(axis=1, keepdims=True)).ravel()
        return np.concatenate(list(pieces.values()))

    def outcome(self, values: Mapping[str, float]) -> Array:
        """The measured channels of the plant with these parameters."""
        return self.measured(self.respond(values))

    def slopes(self, rival: Fit, free: Sequence[FreeParameter], outcome: Array) -> Array:
        """Derivatives of a rival's outcome with respect to these parameters' coordinates: (samples, parameters)."""
        slopes = np.zeros((len(outcome), len(free)))
        at = coordinates(free, rival.values)
        for column, nudge in enumerate(NUDGE * np.eye(len(free))):
            values = values_at(rival.values, free, at + nudge)
            moved, reached = (coordinates(free, values) - at)[column], self.outcome(values)
            if moved != 0.0 and np.all(np.isfinite(reached)):
                slopes[:, column] = (reached - outcome) / moved
        return slopes


def _is_bearable(rows: Array, values: Mapping[str, float], limits: Limits | None) -> bool:
    """Whether motion and pressures stay within the limits; no trial exceeds that of the voltage."""
    bears = limits_of(values) if limits is None else limits
    shares = bears.shares(rows, STEP * ROWS_EVERY, values["atmospheric_pressure"])
    return all(share < 1.0 for name, share in shares.items() if name != "voltage")


@dataclass(frozen=True)
class _Slopes:
    """Derivatives of an outcome with respect to the coordinates of `free`: (samples, parameters)."""

    free: tuple[FreeParameter, ...]
    columns: Array

    @cached_property
    def priors(self) -> Array:
        """Inverse standard deviations of the coordinates."""
        return np.array([1.0 / parameter.prior_deviation for parameter in self.free])

    def towards(self, difference: Array, q: Array, damping: float = 0.0) -> Array:
        """The damped step from q that reduces a difference of outcomes, limited by the priors."""
        normal = self.columns.T @ self.columns + np.diag(self.priors**2)
        scale = 1.0 / np.sqrt(np.diag(normal))
        right = self.columns.T @ difference - self.priors**2 * q
        damped = normal * np.outer(scale, scale) + damping * np.eye(len(scale))
        return np.asarray(scale * np.linalg.solve(damped, scale * right))

    def misfit(self, difference: Array, q: Array) -> float:
        """Chi^2 of a difference, and of the priors at q."""
        return float(difference @ difference + np.sum((self.priors * q) ** 2))

    def left_of(self, difference: Array) -> float:
        """Chi^2 of a small difference after these parameters were fitted to it."""
        move = self.towards(difference, np.zeros(len(self.free)))
        return self.misfit(difference - self.columns @ move, move)


def _imitating(target: Array, test: _Test, rival: Fit, slopes: _Slopes, outcome: Array) -> Array:
    """A rival's outcome after its parameters were fitted to another's outcome."""
    q = coordinates(slopes.free, rival.values)
    misfit, damping = slopes.misfit(target - outcome, q), 1e-4
    for _ in range(MOVES if slopes.free else 0):
        moved = q + slopes.towards(target - outcome, q, damping)
        values = values_at(rival.values, slopes.free, moved)
        moved, reached = coordinates(slopes.free, values), test.outcome(values)
        left = slopes.misfit(target - reached, moved)
        if not left < misfit:  # a response that ran away leaves no number
            damping *= 100.0
            continue
        gain, q, outcome, misfit = misfit - left, moved, reached, left
        if gain < SETTLED:
            break
        damping *= 0.01
    return outcome
