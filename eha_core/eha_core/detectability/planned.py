"""A planned test: a command on the rig as modelled, and the channels to be recorded with their noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eha_core.diagnosis.calibrate import STEPS
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.detection.responses import FittedModel
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.columns import Column
from eha_core.diagnosis.search.pool import Pool, Trace
from eha_core.errors import ParameterError
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.identification.observation import FITTED, SHORTEST, TICK, Measured, Observation
from eha_core.identification.problem import whole
from eha_core.identification.segments import cut
from eha_core.nominal import NominalModel
from eha_core.plant import COLUMNS, Plant, Trajectory
from eha_core.plant.plant_file import require_voltage
from eha_core.recording.simulated import POSITION_NOISE, PRESSURE_NOISE

Array = NDArray[np.float64]

NOISE = {"position": POSITION_NOISE, "pressure_a": PRESSURE_NOISE, "pressure_b": PRESSURE_NOISE}
"""The channels that can be recorded, and the standard deviation of each one's noise at factor 1 [m, Pa]."""

LONGEST = 600.0
"""s; a longer test takes minutes and gigabytes (assumed)."""


@dataclass(frozen=True)
class PlannedTest:
    """A command, and how the response is recorded.

    Attributes:
        times, voltages: the command [V] from each instant on [s].
        duration: [s].
        channels: those of NOISE that are recorded in addition to the command.
        noise: factor on NOISE.
        rate: samples per second [Hz].
    """

    times: Array
    voltages: Array
    duration: float
    channels: tuple[str, ...] = tuple(NOISE)
    noise: float = 1.0
    rate: float = 500.0

    def __post_init__(self) -> None:
        """Check that a diagnosis could use the recording."""
        unknown = [name for name in self.channels if name not in NOISE]
        if unknown:
            raise ParameterError(f"there is no channel {unknown[0]} to compare with; give some of {', '.join(NOISE)}")
        if "position" not in self.channels:
            raise ParameterError("position is not among the channels, and a diagnosis needs it; record it, too")
        if not SHORTEST <= self.duration <= LONGEST:
            raise ParameterError(f"duration = {self.duration:g} s is out of range; give {SHORTEST:g} to {LONGEST:g} s")
        if not 1e-3 <= self.noise <= 1e6:
            raise ParameterError(f"noise = {self.noise:g} is out of range; give 0.001 to 1e6")
        if not 20.0 <= self.rate <= 1.0 / STEPS[0]:
            raise ParameterError(f"rate = {self.rate:g} Hz is out of range; give 20 to {1.0 / STEPS[0]:g}")
        if np.ptp(self.voltages) == 0.0:
            raise ParameterError("the command is constant and excites nothing; give another signal")

    def recording(self, channels: tuple[str, ...]) -> PlannedTest:
        """The same test with other channels recorded."""
        return replace(self, channels=channels)


@dataclass(frozen=True)
class RigAsModelled(FittedModel):
    """The rig as modelled in this test: an exact fit, and `motion`, the response."""

    motion: Trajectory
    model: NominalModel
    test: PlannedTest

    def with_effect(self, column: Column) -> RigAsModelled:
        """The same test of a rig with an effect, as its sensors would record it without noise."""
        values = {**self.model.values, **column.beside(self.fit.values).values}
        return linearised(replace(self.model, values=values), self.test)


def linearised(model: NominalModel, test: PlannedTest) -> RigAsModelled:
    """The noise-free test of the rig as modelled, linearised as in the search over its long windows.

    Raises ParameterError for an actuator that no voltage drives.
    """
    require_voltage(model.composition)
    values, step = model.values, STEPS[0]
    steps = round(test.duration / TICK) * round(TICK / step)
    held = np.searchsorted(test.times, np.arange(steps) * step + 1e-9, side="right") - 1
    voltages = np.where(held >= 0, test.voltages[np.maximum(held, 0)], 0.0).astype(np.float64)
    motion = Plant(model.composition.named(values), step, composition=model.composition).run(voltages)
    at = np.arange(1, int(test.duration * test.rate)) / test.rate
    measured = tuple(
        Measured(name, FITTED.index(name), at,
                 np.interp(at, motion.time, motion.values[:, COLUMNS.index(f"measured_{name}")]),
                 test.noise * NOISE[name])
        for name in FITTED if name in test.channels
    )  # fmt: skip
    observation = Observation(
        "planned", "voltage", ((np.arange(steps, dtype=np.float64) * step, voltages),), measured, (), test.duration,
        ("voltage_command", *test.channels), (), (), composition=model.composition,
    )  # fmt: skip
    problem = whole(cut(observation, values, step))
    states = problem.shooting.initial_states.copy()
    names = ("position", "velocity", "pressure_a", "pressure_b")
    rows = motion.values[:, [COLUMNS.index(name) for name in names]]
    later = problem.shooting.edges[1:-1]
    states[1:] = rows[later - 1]
    travel = float(np.max(np.abs(motion.position)))
    plant = free_nominal_parameters(values, "voltage", travel, model.unknown, model.composition)
    pool = Pool(problem, plant, Trace())
    # with a command that does not begin at zero, coil and spool start differently from the windows: that is no noise
    exact = replace(pool.at_rest(NOTHING, values, states), data=0.0, objective=0.0)
    scales = characteristic_scales([observation], problem.shooting, exact)
    return RigAsModelled((observation,), pool, NOTHING, exact, scales, motion, model, test)
