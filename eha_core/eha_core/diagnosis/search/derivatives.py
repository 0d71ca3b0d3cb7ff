"""Derivatives about a fit, by its parameters and the windows' states, and secants of what could be added.

A search spends most of its time on these simulations, so what was simulated about a fit is not simulated again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from eha_core.diagnosis.search.columns import Column
from eha_core.identification.fit import Fit
from eha_core.identification.free_parameters import FreeParameter, coordinates
from eha_core.identification.numbers import Array
from eha_core.identification.per_recording import in_each
from eha_core.identification.problem import Linearised, Problem, changes, linearise

Secants = tuple[list[Column], Array, Array]
"""Columns; what each changes, (samples, columns) in units of noise; and by how much it shifts the windows' end states,
(windows, 4, columns). Nothing where a simulation ran away."""


@dataclass(frozen=True)
class Derivatives:
    """The derivatives about a fit, by the `nominal` parameters that come first in its `free`, by the others and by the
    states."""

    problem: Problem
    at: Fit
    nominal: int
    linear: Linearised
    _known: list[tuple[Sequence[Column], Secants]] = field(default_factory=list, repr=False)

    def secants(self, columns: Sequence[Column]) -> Secants:
        """What each column changes where the fit stands; of the last ones asked for it is known."""
        if not self._known or self._known[0][0] != columns:
            self._known[:] = [(columns, self._simulated(columns))]
        return self._known[0][1]

    def _simulated(self, columns: Sequence[Column]) -> Secants:
        values, states = self.at.values, self.at.states
        beside = [column.beside(values) for column in columns]
        moved, shifts = changes(
            self.problem, (values, states), [({**values, **column.values}, states) for column in beside]
        )
        usable = np.all(np.isfinite(moved), axis=0) & np.any(moved != 0.0, axis=0)
        moved[:, ~usable], shifts[:, :, ~usable] = 0.0, 0.0
        return beside, moved, shifts


def derivatives(problem: Problem, at: Fit, plant: Sequence[FreeParameter]) -> Derivatives:
    """Linearise about a fit of a set, over the parameters of the `plant` and its members'."""
    shooting = problem.shooting
    nominal, _ = in_each(plant, at.values, shooting.per_recording, len(shooting.first_windows))
    own, _ = in_each(at.free, at.values, shooting.per_recording, len(shooting.first_windows))
    names = {parameter.name for parameter in nominal}
    free = (*nominal, *(parameter for parameter in own if parameter.name not in names))
    q = coordinates(free, at.values)
    linear = linearise(problem, at.values, free, q, at.states)
    return Derivatives(problem, replace(at, free=free, q=q), len(nominal), linear)
