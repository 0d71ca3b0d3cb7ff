"""The search's own linearisation of a planned test: what is left of responses when others explain what they can."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_core.detectability.planned import Linearised
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.box import within_bounds
from eha_core.diagnosis.search.columns import Column
from eha_core.diagnosis.search.quadratic import QuadraticModel, quadratic_model

MENTIONED = 2
"""Nominal parameters that are named as those that compensate an effect."""


COMPENSATED = 0.01
"""Share of an effect's response that nominal parameters must leave for the effect not to be called compensated by
them (assumed): of less, the size that is found is ten times what it would be with a rig that is exactly known."""


@dataclass(frozen=True)
class Responses:
    """The responses of columns at their sizes, in the search's quadratic model of the test about the rig as modelled.

    Chi^2 is without noise: what a fit would be left with. Nominal parameters move within their priors and bounds.
    """

    model: QuadraticModel
    usable: NDArray[np.bool_]
    """(columns,) whether the search can use a column at all."""

    def energy(self, column: int) -> float:
        """Chi^2 of a column's response where the nominal parameters are held."""
        place = self.model.nominal + column
        return float(self.model.matrix[place, place] * self.model.scale[place] ** 2)

    def left(self, column: int, others: Sequence[int] = (), without: int | None = None) -> float:
        """Chi^2 of a column's response that the nominal parameters (but for one, by its place) and other columns do not
        explain, each within its bounds."""
        model, count = self.model, self.model.nominal
        places = np.array([*(k for k in range(count) if k != without), *(count + k for k in others)], dtype=np.int64)
        scale = model.scale[count + column]
        gradient = model.matrix[:, count + column] * scale
        gain = within_bounds(
            model.matrix, gradient, model.lower, model.upper, places, len(places), np.empty(len(places))
        )
        return max(self.energy(column) - max(gain, 0.0), 0.0)

    def share(self, column: int) -> float:
        """The share of a column's response that the nominal parameters do not explain."""
        return self.left(column) / (self.energy(column) or 1.0)

    def compensating(self, column: int) -> tuple[str, ...]:
        """The nominal parameters without which most of a column's response would be left."""
        found = [self.left(column, without=place) for place in range(self.model.nominal)]
        names = [parameter.name for parameter in self.model.at.free]
        return tuple(names[place] for place in np.argsort(found)[::-1][:MENTIONED])

    def deviations(self) -> dict[str, float]:
        """Standard deviation of the coordinate of each nominal parameter in this test, no effect fitted, by name."""
        count = self.model.nominal
        spread = np.sqrt(np.diag(np.linalg.inv(self.model.matrix[:count, :count]))) / self.model.scale[:count]
        return {one.name: float(at) for one, at in zip(self.model.at.free, spread, strict=True)}


def responses(at: Linearised, columns: Sequence[Column]) -> Responses:
    """The responses of these columns in the test, from one Jacobian and one secant each."""
    model = quadratic_model(at.pool.problem, at.fit, NOTHING, at.pool.plant, columns)
    usable = np.zeros(len(columns), dtype=np.bool_)
    usable[[place - model.nominal for option in model.options for place in option.places]] = True
    return Responses(model, usable)
