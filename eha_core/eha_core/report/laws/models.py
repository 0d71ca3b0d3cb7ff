"""The models of a diagnosis, and the weak form in which they are compared with measured channels.

Each equation is multiplied by a smooth test function in time and integrated by parts, so that no measured channel is
differentiated (see `eha_core.weak_form.grid`). A law's point is the law averaged with that test function plus the
equation's residual, measured minus modelled: the component-plus-residual plot of W. A. Larsen and S. J. McCleary,
Technometrics 14 (1972). All other terms of the equation, named effects included, cancel out.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_core.diagnosis.result import Diagnosis, NamedEffect
from eha_core.identification.numbers import Array
from eha_core.identification.observation import Measured
from eha_core.parameters import nominal_values
from eha_core.weak_form.grid import HOPS, Grid, make_grid

POINT_WIDTH = 0.02
"""s; half width of a point's test function: some ten samples, and short compared with the time between reversals."""

SLOWEST = 0.2
"""Share of its mean speed under a test function below which the piston counts as stopping or reversing there."""

LIQUID = ("position", "pressure_a", "pressure_b")


class Models:
    """The data of the laws: parameter values, and channels on one grid."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        self.diagnosis = diagnosis
        self.fitted: Mapping[str, float] = {**nominal_values(), **diagnosis.fitted_values}
        self.nominal: Mapping[str, float] = {
            **self.fitted,
            **{parameter.name: parameter.nominal for parameter in diagnosis.parameters},
        }

    @cached_property
    def grid(self) -> Grid | None:
        """The test functions; None where position or a pressure was not measured."""
        pictures = self.diagnosis.pictures
        if not all(name in pictures.after for name in LIQUID):
            return None
        begin, end = self.diagnosis.drawn
        channels = [Measured(name, 0, pictures.time[name] - begin, pictures.measured[name], 0.0) for name in LIQUID]
        step = max(float(np.median(np.diff(channel.time))) for channel in channels)
        return make_grid(end - begin, step, channels, POINT_WIDTH)

    def on_grid(self, source: Mapping[str, Array]) -> tuple[Array, ...]:
        """Position and both pressures of `pictures.measured` or of a model, on the grid."""
        assert self.grid is not None
        time = self.grid.time + self.diagnosis.drawn[0]
        return tuple(np.interp(time, self.diagnosis.pictures.time[name], source[name]) for name in LIQUID)

    @cached_property
    def modelled(self) -> tuple[Array, Array, Array, Array]:
        """Position, velocity and both pressures of the final model on the grid."""
        assert self.grid is not None
        x, a, b = self.on_grid(self.diagnosis.pictures.after)
        return x, np.gradient(x, self.grid.step), a, b

    @cached_property
    def keeps_moving(self) -> NDArray[np.bool_]:
        """The test functions under which the piston keeps moving in one direction."""
        assert self.grid is not None
        speed = np.abs(self.modelled[1])
        under = np.lib.stride_tricks.sliding_window_view(speed, len(self.grid.weight))
        under = under[:: len(self.grid.weight) // HOPS][self.grid.gap_free]
        return np.asarray(under.min(axis=-1) > SLOWEST * under.mean(axis=-1))

    @cached_property
    def spool(self) -> Array | None:
        """The nominal spool position on the grid [A]; None where no voltage was recorded."""
        variables = self.diagnosis.pictures.variables
        if self.grid is None or "spool_position" not in variables:
            return None
        return np.interp(self.grid.time + self.diagnosis.drawn[0], variables["time"], variables["spool_position"])

    def deviation(self, name: str) -> float:
        """Standard deviation of a fitted parameter of the nominal model; 0 where it was not fitted."""
        found = next((parameter.std for parameter in self.diagnosis.parameters if parameter.name == name), 0.0)
        return found if np.isfinite(found) else 0.0

    def state(self, name: str) -> Array:
        """A state's values in the final model, else in the recalibrated one; empty where neither has them."""
        known = ("position", "velocity", "pressure_a", "pressure_b")
        if self.grid is not None and name in known:
            return self.modelled[known.index(name)]
        return self.diagnosis.pictures.variables.get(name, np.empty(0))


def contribution(effect: NamedEffect) -> tuple[Any, int]:
    """The compiled contribution of an effect, and how many memory slots it has."""
    module = import_module(f"eha_core.effects.{effect.id}")
    return module.contribution, len(module.EFFECT.memory)


def values_of(effect: NamedEffect) -> dict[str, float]:
    """An effect's parameters as fitted, without their deviations."""
    return {name: fitted.value for name, fitted in effect.parameters.items()}


def in_order(effect: NamedEffect, values: Mapping[str, float]) -> list[float]:
    """An effect's parameters in the order of its declaration."""
    module = import_module(f"eha_core.effects.{effect.id}")
    return [float(values[row.name]) for row in module.EFFECT.parameters]
