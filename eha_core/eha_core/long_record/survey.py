"""What each block of a record shows: which commands, speeds, positions and pressures occur together in it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain

import numpy as np

from eha_core.errors import RecordingError
from eha_core.identification.numbers import Array
from eha_core.identification.observation import Observation, observe
from eha_core.identification.segments import smooth
from eha_core.plant import Composition
from eha_core.recording.blocks import Block

INSTANTS = 256
"""Instants of a block that are looked at: 25 Hz of 10 s, some 10 kB of numbers (assumed)."""

CELLS = 10
"""Parts into which the range of each quantity is divided (assumed)."""

AT_REST = 0.02
"""Share of the largest speed below which the piston counts as standing still (assumed)."""

MOVES = 3.0
"""Standard deviation of the position over its noise below which a block shows nothing: of a rig at rest it is 1
(assumed)."""

EXTREME = 0.001
"""Share of all instants that may lie beyond a range at either end: outliers make no range."""


@dataclass(frozen=True)
class Shown:
    """The instants of one block: (instants, quantities) of the driving channel, its change over an instant, the
    position, the speed, and the pressures' difference where they were measured; `further` has each further driving
    channel, as the sign that switches a pump's valve, and its change (instants, 2)."""

    number: int
    start: float
    end: float
    instants: Array
    further: tuple[Array, ...] = ()


def shown(block: Block, composition: Composition) -> Shown | None:
    """What a block shows; None where no diagnosis could use it, as of a rig at rest."""
    if block.recording is None:
        return None
    try:
        observation = observe(block.recording, composition)
    except RecordingError:
        return None
    position = observation.channel("position")
    if position is None or float(np.std(position.values)) < MOVES * position.noise:
        return None
    at = np.linspace(0.0, observation.duration, INSTANTS, dtype=np.float64)
    first, *further = (_driving(time, values, at) for time, values in observation.inputs)
    return Shown(block.number, block.start, block.end, _instants(observation, first, at), tuple(further))


def _driving(time: Array, values: Array, at: Array) -> Array:
    held = values[np.clip(np.searchsorted(time, at, side="right") - 1, 0, None)]
    return np.stack([held, np.gradient(held)], axis=1)


def _instants(observation: Observation, driving: Array, at: Array) -> Array:
    position = observation.channel("position")
    assert position is not None, "observe asks for it"
    columns = [
        *driving.T,
        np.interp(at, position.time, position.values),
        np.interp(at, position.time, smooth(position, 1)),
    ]
    pressures = [observation.channel(name) for name in ("pressure_a", "pressure_b")]
    if all(channel is not None for channel in pressures):
        first, second = (np.interp(at, channel.time, channel.values) for channel in pressures if channel is not None)
        columns.append(first - second)
    return np.stack(columns, axis=1)


def cells(blocks: list[Shown]) -> list[frozenset[int]]:
    """The cells that each block visits: of (command, its change) for every driving channel, (position, speed) and
    (pressures' difference, speed), each quantity's range over the record divided evenly, and the speed's around
    standstill once more."""
    width, further = min(block.instants.shape[1] for block in blocks), min(len(block.further) for block in blocks)
    quantities = [np.hstack([block.instants[:, :width], *block.further[:further]]) for block in blocks]
    everything = np.concatenate(quantities)
    lowest, highest = np.quantile(everything, [EXTREME, 1.0 - EXTREME], axis=0)
    spread = np.where(highest > lowest, highest - lowest, 1.0)
    rest = AT_REST * float(np.max(np.abs([lowest[3], highest[3]])))
    pairs = [(0, 1), (2, 3), *([(4, 3)] if width > 4 else [])]
    pairs += [(place, place + 1) for place in range(width, width + 2 * further, 2)]
    found = []
    for values in quantities:
        part = np.clip(((values - lowest) / spread * CELLS).astype(np.int64), 0, CELLS - 1)
        part[:, 3] = np.where(np.abs(values[:, 3]) < rest, CELLS, part[:, 3])
        each = [
            (number * (CELLS + 1) + part[:, first]) * (CELLS + 1) + part[:, second]
            for number, (first, second) in enumerate(pairs)
        ]
        found.append(frozenset(chain.from_iterable(numbers.tolist() for numbers in each)))
    return found
