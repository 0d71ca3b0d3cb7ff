"""The search's own linearisation about a fitted model: the parts of responses that other parameters do not explain."""

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
from eha_core.diagnosis.search.derivatives import Derivatives
from eha_core.diagnosis.search.pool import Pool
from eha_core.diagnosis.search.quadratic import QuadraticModel, with_columns
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.observation import Observation

MENTIONED = 2
"""Most fitted parameters that are named as compensating for an effect."""

COMPENSATED = 0.01
"""Share of an effect's response, not explained by fitted parameters, below which the effect counts as compensated by
them (assumed): the detectable size is then ten times that on an exactly known rig."""


@dataclass(frozen=True)
class FittedModel:
    """A fitted set of effects, for which the detectability of others is computed.

    Attributes:
        observations: the recordings, or the planned test.
        pool: of the windows that it was fitted to, with the fit of the nominal equations.
        hypothesis: the set. fit: its fit.
        scales: of the motion.
    """

    observations: tuple[Observation, ...]
    pool: Pool
    hypothesis: Hypothesis
    fit: Fit
    scales: Scales

    @cached_property
    def derivatives(self) -> Derivatives:
        """The derivatives about the fit."""
        return self.pool.about(self.hypothesis, self.fit)

    @property
    def variance(self) -> float:
        """Variance of the residual in units of the noise's, never below one."""
        return max(1.0, self.fit.data / self.fit.count)


@dataclass(frozen=True)
class Responses:
    """The responses of columns at their sizes, in the search's quadratic model about a fitted set.

    Chi^2 is without noise: that of a fit's residual. The set's free parameters, nominal ones and those of its effects,
    move within priors and bounds.
    """

    model: QuadraticModel
    usable: NDArray[np.bool_]
    """(columns,) whether the search can use a column at all."""

    @property
    def fitted(self) -> int:
        """The number of the set's free parameters; the columns come after them."""
        return len(self.model.at.free)

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """The scaled bounds of each one's move from the fit."""
        there = self.model.to_neutral * self.model.scale
        return self.model.lower + there, self.model.upper + there

    def energy(self, column: int) -> float:
        """Chi^2 of a column's response with all fitted parameters held."""
        place = self.fitted + column
        return float(self.model.matrix[place, place] * self.model.scale[place] ** 2)

    def left(self, column: int, others: Sequence[int] = (), without: int | None = None) -> float:
        """Chi^2 of a column's response that the fitted parameters (except the one at index `without`) and other columns
        do not explain, each within its bounds."""
        model, count = self.model, self.fitted
        places = np.array([*(k for k in range(count) if k != without), *(count + k for k in others)], dtype=np.int64)
        gradient = model.matrix[:, count + column] * model.scale[count + column]
        gain = within_bounds(model.matrix, gradient, *self.bounds, places, len(places), np.empty(len(places)))
        return max(self.energy(column) - max(gain, 0.0), 0.0)

    def share(self, column: int) -> float:
        """The share of a column's response that the fitted parameters do not explain."""
        return self.left(column) / (self.energy(column) or 1.0)

    def compensating(self, column: int) -> tuple[str, ...]:
        """The fitted parameters that compensate most for a column's response."""
        found = [self.left(column, without=place) for place in range(self.fitted)]
        names = [parameter.name for parameter in self.model.at.free]
        return tuple(names[place] for place in np.argsort(found)[::-1][:MENTIONED])

    def deviations(self) -> dict[str, float]:
        """Standard deviation of each fitted parameter's coordinate, without further effects, by name."""
        count = self.fitted
        spread = np.sqrt(np.diag(np.linalg.inv(self.model.matrix[:count, :count]))) / self.model.scale[:count]
        return {one.name: float(at) for one, at in zip(self.model.at.free, spread, strict=True)}


def responses(at: FittedModel, columns: Sequence[Column]) -> Responses:
    """The responses of these columns together with the set, from one secant each."""
    model = with_columns(at.derivatives, at.hypothesis, columns)
    usable = np.zeros(len(columns), dtype=np.bool_)
    first = len(model.at.free)
    usable[[place - first for option in model.options if not option.present for place in option.places]] = True
    return Responses(model, usable)
