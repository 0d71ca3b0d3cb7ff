"""The error budget: the task is simulated with every subset of a rig's departures, which gives each one's share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_core.error_budget import shapley
from eha_core.error_budget.rig import Departure, Rig
from eha_core.error_budget.task import Task
from eha_core.parameters import catalogue

Array = NDArray[np.float64]

SURE = 1.96
"""Standard deviations to either side that contain 95 % of a normal distribution."""


@dataclass(frozen=True)
class Figure:
    """A value [m] and half of its 95 % interval [m] due to the uncertainty of the departures' values."""

    value: float
    reach: float = 0.0


@dataclass(frozen=True)
class Share:
    """One departure's share of the RMSE, and the reduction of the RMSE if it alone is removed."""

    name: str
    statement: str
    share: Figure
    gain: Figure
    repairable: bool


@dataclass(frozen=True)
class RepairStep:
    """The repair with the largest gain after those before it, and the RMSE after it [m]."""

    name: str
    rmse: Figure


@dataclass(frozen=True)
class Budget:
    """The sources of a rig's tracking error.

    Attributes:
        source: where the rig was read.
        task: the motion.
        today: RMSE of the rig with all its departures.
        modelled: RMSE of the rig as modelled, without departures. With the shares it adds up to `today`.
        shares: of each departure, the largest first.
        order: the repairs, the largest gain first.
        subsets: RMSE [m] of each subset of the departures, by the names in it.
        remarks: assumptions.
    """

    source: str
    task: Task
    today: Figure
    modelled: Figure
    shares: tuple[Share, ...]
    order: tuple[RepairStep, ...]
    subsets: Mapping[tuple[str, ...], float]
    remarks: tuple[str, ...] = ()

    @property
    def repaired(self) -> Figure:
        """RMSE of the rig after all repairs."""
        return self.order[-1].rmse if self.order else self.today


def error_budget(rig: Rig, task: Task) -> Budget:
    """Simulate the task with every subset of the departures, and divide its RMSE among them by Shapley's value.

    Intervals: each value with a known standard deviation is moved by one, and the subsets with it are simulated again.
    The differences, as a linear model, propagate the covariance of the values to every figure.

    Raises ParameterError where the rig cannot perform the task.
    """
    departures = rig.departures
    subsets = [_members(departures, subset) for subset in range(2 ** len(departures))]
    sets = [rig.values(members) for members in subsets]
    directions = _directions(rig)
    moved = _moved(rig, directions)
    having = [(place, subset) for place, name in enumerate(directions) for subset, members in enumerate(subsets)
              if any(name in departure.values for departure in members)]  # fmt: skip
    again = [{**sets[subset], **moved[place]} for place, subset in having]
    found = task.rmse([*sets, *again], rig.modelled, rig.composition)
    values = found[: len(sets)]
    changed = np.repeat(values[None], len(moved), axis=0)
    for (place, subset), rmse in zip(having, found[len(sets) :], strict=True):
        changed[place, subset] = rmse
    signs = np.array(list(directions.values()))
    return _summed_up(rig, task, subsets, values, changed, rig.correlation * np.outer(signs, signs))


def _members(departures: Sequence[Departure], subset: int) -> list[Departure]:
    return [departure for place, departure in enumerate(departures) if subset >> place & 1]


def _directions(rig: Rig) -> dict[str, float]:
    """The sign of each uncertain value's move: up, or down where its bound is nearer than a standard deviation."""
    everything = rig.values(rig.departures)
    return {name: 1.0 if everything[name] + deviation <= catalogue()[name].upper else -1.0
            for name, deviation in rig.deviations.items()}  # fmt: skip


def _moved(rig: Rig, directions: Mapping[str, float]) -> list[dict[str, float]]:
    """Each uncertain value, moved by its standard deviation."""
    everything = rig.values(rig.departures)
    return [{name: max(everything[name] + way * rig.deviations[name], catalogue()[name].lower)}
            for name, way in directions.items()]  # fmt: skip


def _summed_up(
    rig: Rig, task: Task, subsets: Sequence[Sequence[Departure]], values: Array, changed: Array, correlation: Array
) -> Budget:
    """The budget from the RMSE of every subset, (subsets,), and those with each uncertain value moved by a deviation,
    (uncertain, subsets)."""
    departures, count = rig.departures, len(rig.departures)
    order = shapley.fastest_removal(values, [k for k, departure in enumerate(departures) if departure.repairable])

    def figures(rmse: Array) -> Array:
        """Today's RMSE, that as modelled, the shares, the gains, and the RMSE after each repair."""
        left = len(rmse) - 1 - np.cumsum([1 << place for place in order])
        return np.concatenate([rmse[[-1, 0]], shapley.shares(rmse), rmse[-1] - shapley.without_each(rmse), rmse[left]])

    at = figures(values)
    differences = np.array([figures(row) - at for row in changed]).reshape(-1, len(at))
    variance = np.einsum("if,ij,jf->f", differences, correlation, differences)
    reach = SURE * np.sqrt(np.maximum(variance, 0.0))
    made = [Figure(*pair) for pair in np.stack([at, reach], axis=1).tolist()]
    shares = [Share(one.name, one.statement, made[2 + k], made[2 + count + k], one.repairable)
              for k, one in enumerate(departures)]  # fmt: skip
    repairs = [RepairStep(departures[place].name, made[2 + 2 * count + k]) for k, place in enumerate(order)]
    names = (tuple(one.name for one in members) for members in subsets)
    by_names = dict(zip(names, values.tolist(), strict=True))
    shares.sort(key=lambda row: -row.share.value)
    return Budget(rig.source, task, made[0], made[1], tuple(shares), tuple(repairs), by_names, rig.remarks)
