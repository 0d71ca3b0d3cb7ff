"""The search's own linearisation about a fitted model: what is left of responses when others explain what they can."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.hypothesis import Hypothesis
from eha_core.diagnosis.search.box import within_bounds
from eha_core.diagnosis.search.columns import Column
from eha_core.diagnosis.search.pool import Pool
from eha_core.diagnosis.search.quadratic import QuadraticModel, quadratic_model
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.observation import Observation

MENTIONED = 2
"""Fitted parameters that are named as those that compensate an effect."""

COMPENSATED = 0.01
"""Share of an effect's response that fitted parameters must leave for the effect not to be called compensated by
them (assumed): of less, the size that is found is ten times what it would be with a rig that is exactly known."""


@dataclass(frozen=True)
class FittedModel:
    """A fitted set of effects, of which it is asked what else would have shown.

    Attributes:
        observations: the recordings, or the test that is planned.
        pool: of the windows that it was fitted to, with the nominal equations where they were fitted.
        hypothesis: the set. fit: of it.
        scales: of the motion.
    """

    observations: tuple[Observation, ...]
    pool: Pool
    hypothesis: Hypothesis
    fit: Fit
    scales: Scales

    @property
    def variance(self) -> float:
        """Of the residual in units of the noise's variance, never below one."""
        return max(1.0, self.fit.data / self.fit.count)


@dataclass(frozen=True)
class Responses:
    """The responses of columns at their sizes, in the search's quadratic model about a fitted set.

    Chi^2 is without noise: what a fit would be left with. What the set has free, its nominal parameters and those of
    its effects, moves within priors and bounds.
    """

    model: QuadraticModel
    usable: NDArray[np.bool_]
    """(columns,) whether the search can use a column at all."""

    @property
    def fitted(self) -> int:
        """How many parameters the set has free; the columns come after them."""
        return len(self.model.at.free)

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """How far each may move from the fit, scaled."""
        there = self.model.to_neutral * self.model.scale
        return self.model.lower + there, self.model.upper + there

    def energy(self, column: int) -> float:
        """Chi^2 of a column's response where all that was fitted is held."""
        place = self.fitted + column
        return float(self.model.matrix[place, place] * self.model.scale[place] ** 2)

    def left(self, column: int, others: Sequence[int] = (), without: int | None = None) -> float:
        """Chi^2 of a column's response that the fitted parameters (but for one, by its place) and other columns do not
        explain, each within its bounds."""
        model, count = self.model, self.fitted
        places = np.array([*(k for k in range(count) if k != without), *(count + k for k in others)], dtype=np.int64)
        gradient = model.matrix[:, count + column] * model.scale[count + column]
        gain = within_bounds(model.matrix, gradient, *self.bounds, places, len(places), np.empty(len(places)))
        return max(self.energy(column) - max(gain, 0.0), 0.0)

    def share(self, column: int) -> float:
        """The share of a column's response that the fitted parameters do not explain."""
        return self.left(column) / (self.energy(column) or 1.0)

    def compensating(self, column: int) -> tuple[str, ...]:
        """The fitted parameters without which most of a column's response would be left."""
        found = [self.left(column, without=place) for place in range(self.fitted)]
        names = [parameter.name for parameter in self.model.at.free]
        return tuple(names[place] for place in np.argsort(found)[::-1][:MENTIONED])

    def deviations(self) -> dict[str, float]:
        """Standard deviation of the coordinate of each fitted parameter, no more effects fitted, by name."""
        count = self.fitted
        spread = np.sqrt(np.diag(np.linalg.inv(self.model.matrix[:count, :count]))) / self.model.scale[:count]
        return {one.name: float(at) for one, at in zip(self.model.at.free, spread, strict=True)}


def responses(at: FittedModel, columns: Sequence[Column]) -> Responses:
    """The responses of these columns together with the set, from one Jacobian and one secant each."""
    pool = at.pool
    model = quadratic_model(pool.posed(at.hypothesis), at.fit, at.hypothesis, pool.plant, columns)
    usable = np.zeros(len(columns), dtype=np.bool_)
    first = len(model.at.free)
    usable[[place - first for option in model.options if not option.present for place in option.places]] = True
    return Responses(model, usable)
