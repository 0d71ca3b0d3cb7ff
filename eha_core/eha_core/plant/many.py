"""Many plants under one command, for sweeps and Monte Carlo studies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from eha_core.errors import ParameterError
from eha_core.plant.composition import PAPER, Composition
from eha_core.plant.lane_rows import LANES
from eha_core.plant.lockstep import LockStep
from eha_core.plant.simulator import Array, Plant, check_step_size, starting_pressures, step_inputs
from eha_core.plant.state import COLUMNS, SEEN

MOST_BYTES = 4e9
"""The largest result that is attempted (assumed: what a small machine can hold)."""


@dataclass(frozen=True)
class Trajectories:
    """Simulated records of several plants: `time` (n,) in s and `values` (plants, n, len(columns)).

    Each column is an attribute of its name, (plants, n).
    """

    time: Array
    values: Array
    columns: tuple[str, ...]

    def __getattr__(self, name: str) -> Array:
        try:
            return self.values[:, :, self.columns.index(name)]
        except ValueError:
            raise AttributeError(name) from None


def simulate_many(
    parameters: Sequence[Mapping[str, float]],
    command: Array,
    *,
    step_size: float = 1e-4,
    every: int = 1,
    initial_position: float = 0.0,
    columns: Sequence[str] = COLUMNS,
    jobs: int = 1,
    composition: Composition = PAPER,
) -> Trajectories:
    """Simulate a plant for each of `parameters` (what differs from the nominal ones) under one command.

    Each gives, to the last bit, what `Plant(parameters, step_size, initial_position).run(command, every)` gives. Plants
    on a servo valve go in lock-step, those of other sources one after another.

    Args:
        command: (steps,) voltage [V] of each step, or what else drives the source, as `Plant.run` takes it.
        step_size: [s]; every `every`-th step gives a row.
        columns: which of COLUMNS to keep; SEEN, what the sensors say, costs least.
        jobs: threads.
        composition: the parts of every plant.

    Raises ParameterError for parameters that make no plant, saying which, for a step or a start out of range, for a
    voltage that is not finite, and for a result that would take more than MOST_BYTES.
    """
    check_step_size(step_size)
    held = step_inputs(command, composition.source)
    unknown = set(columns) - set(COLUMNS)
    if unknown:
        raise ParameterError(f"there is no column {min(unknown)}; there are {', '.join(COLUMNS)}")
    if every < 1 or jobs < 1:
        raise ParameterError(f"every = {every} and jobs = {jobs} must both be 1 or more")
    sets = [_complete(number, changes, initial_position, composition) for number, changes in enumerate(parameters)]
    shape = (len(sets), len(held) // every, len(columns))
    if 8.0 * np.prod(shape, dtype=np.float64) > MOST_BYTES:
        raise ParameterError(
            f"{shape[0]} plants x {shape[1]} rows x {shape[2]} columns take {8e-9 * np.prod(shape):.1f} GB; "
            "give a larger `every`, fewer `columns`, or fewer plants at a time"
        )
    values = np.empty(shape)
    kept = SEEN if set(columns) <= set(SEEN) else COLUMNS
    places = [kept.index(name) for name in columns]

    def fill(first: int) -> None:
        block = sets[first : first + LANES]
        rows = _rows(block, held, step_size, every, initial_position, len(kept), composition)
        values[first : first + LANES] = rows[:, places, : len(block)].transpose(2, 0, 1)

    def fill_alone(first: int) -> None:
        for number, parameter_set in enumerate(sets[first : first + LANES], first):
            rows = Plant(parameter_set, step_size, initial_position, composition).run(command, every).values
            values[number] = rows[:, [COLUMNS.index(name) for name in columns]]

    together = composition.source.valve == "coil"
    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(fill if together else fill_alone, range(0, len(sets), LANES)))
    time = every * np.arange(1, shape[1] + 1, dtype=np.float64) * step_size
    return Trajectories(time, values, tuple(columns))


def _complete(
    number: int, changes: Mapping[str, float], initial_position: float, composition: Composition
) -> dict[str, float]:
    try:
        values = composition.changed(composition.nominal_values(), changes)
    except ParameterError as error:
        raise ParameterError(f"parameter set {number}: {error}") from error
    stroke, unit = composition.places(values)["actuator_displacement"], composition.cylinder.motion
    if not abs(initial_position) <= stroke:
        raise ParameterError(
            f"parameter set {number}: initial_position = {initial_position:g} {unit} is outside the stroke of "
            f"+-{stroke:g} {unit}"
        )
    return values


def _rows(
    block: Sequence[Mapping[str, float]], command: Array, step_size: float, every: int, position: float, width: int,
    composition: Composition,
) -> Array:  # fmt: skip
    """Rows (n, width, lanes) of the plants of one block."""
    sets = [composition.places(values) for values in block]
    lanes = LockStep(sets, step_size)
    starts = [starting_pressures(places, position, composition) for places in sets]
    lanes.place(np.array([[position, 0.0, *pressures] for pressures in starts]))
    lanes.start_memory()
    rows = np.empty((len(command) // every, width, lanes.lanes))
    lanes.advance(0, command[None], every, rows)
    return rows
