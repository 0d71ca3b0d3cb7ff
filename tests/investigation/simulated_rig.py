"""A rig in memory: the plant under each voltage, sensors with noise, and the watch that a real one has."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.experiment.limits import Limits
from eha_core.investigation import Motion, MotionStopped, Watch
from eha_core.plant import Plant
from eha_core.recording import Recording

PERIOD, STEPS = 2e-3, 20
NOISE = {"position": 1e-5, "pressure_a": 1e4, "pressure_b": 1e4}


class SimulatedRig:
    """Runs motions on a plant with these parameters; `names` and `voltages` have what was run."""

    def __init__(self, parameters: Mapping[str, float], limits: Limits, position: float = 0.0) -> None:
        self._plant = Plant(dict(parameters), PERIOD / STEPS, position)
        self._limits = limits
        self._generator = np.random.default_rng(1)
        self._time = 0.0
        self.stopped = ""
        self.names: list[str] = []
        self.rows: list[list[tuple[float, ...]]] = []

    def run(self, motion: Motion, name: str) -> Recording:
        self.check()
        watch, rows, begin = Watch(self._limits), [], self._time
        self.names.append(name)
        self.rows.append(rows)
        while True:
            position, *pressures = self._sense()
            chambers = dict(zip(("pressure_a", "pressure_b"), pressures, strict=True))
            trouble = watch.trouble(self._time, position, chambers)
            voltage = None if trouble else motion(self._time - begin, position)
            rows.append((self._time - begin, voltage or 0.0, position, *pressures))
            self._advance(voltage or 0.0)
            if trouble:
                self.stopped = trouble
                raise MotionStopped(trouble)
            if voltage is None:
                return self._recorded(rows, name)

    def check(self) -> None:
        if self.stopped:
            raise MotionStopped(self.stopped)

    @property
    def position(self) -> float:
        return self._plant.state.position

    def _advance(self, voltage: float) -> None:
        self._plant.advance(voltage, STEPS)
        self._time += PERIOD

    def _sense(self) -> tuple[float, float, float]:
        state = self._plant.state
        sensed = (state.measured_position, state.measured_pressure_a, state.measured_pressure_b)
        noise = np.array(list(NOISE.values())) * self._generator.standard_normal(3)
        return tuple(float(each) for each in np.add(sensed, noise))

    @staticmethod
    def _recorded(rows: list[tuple[float, ...]], name: str) -> Recording:
        time, voltage, position, pressure_a, pressure_b = np.array(rows).T
        return Recording.from_arrays(
            time=time, voltage_command=voltage, position=position, pressure_a=pressure_a, pressure_b=pressure_b,
            pressures="gauge", name=name,
        )  # fmt: skip
