"""Whether a test stays within limits on rigs whose parameters differ from the modelled ones within their priors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from eha_core.detectability.planned import Array
from eha_core.diagnosis.calibrate import STEPS
from eha_core.diagnosis.experiment.command_signal import CommandSignal
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.errors import EhaError
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.nominal import NominalModel
from eha_core.plant import simulate_many
from eha_core.plant.plant_file import require_voltage

RIGS = 59
"""Sampled rigs, none of which may exceed a limit: then, with 95 % confidence, fewer than 5 % of such rigs would
(0.95^59 is 0.048)."""

TOGETHER = 20
"""Rigs that are simulated at once, limited by the memory of their rows."""

EVERY = 10
"""Steps between two rows that are compared with the limits: 2 ms, in which a valve hardly moves."""

FULL = 0.97
"""Share of a limit that the amplitude is chosen for, on the rig that reaches most."""

PASSES = 4
"""Simulations of each signal to find its amplitude: the response is nearly linear in it."""

FIRST = 0.02
"""Share of the largest voltage with which the search begins, far from the ends of the stroke."""


@dataclass(frozen=True)
class Margins:
    """Limits, and rigs that have to stay within them: the one as modelled first, then RIGS with sampled parameters.

    Attributes:
        model: the rig as modelled. limits: the limits.
        rigs: values of each rig, in the names of the actuator's parts.
        shares: for each rig, the share of each limit that it reaches in the test of `reached`, by the limit's name.
        bands: of a few quantities over `time` [s], the least of any rig, that of the rig as modelled, and the most:
            (3, samples).
    """

    model: NominalModel
    limits: Limits
    rigs: tuple[Mapping[str, float], ...]
    shares: tuple[Mapping[str, float], ...] = ()
    time: Array | None = None
    bands: Mapping[str, Array] | None = None

    @classmethod
    def of(cls, model: NominalModel, limits: Limits) -> Margins:
        """Rigs with parameters drawn uniformly within one prior standard deviation of the nominal ones; the stroke,
        which is known, is not varied. Raises ParameterError for an actuator that no voltage drives."""
        require_voltage(model.composition)
        values, named = model.values, model.composition.named
        plant = free_nominal_parameters(values, "voltage", 0.0, model.unknown, model.composition)
        moved = [one for one in plant if one.name != "actuator_displacement"]
        generator = np.random.default_rng(RIGS)
        rigs = [named(values)]
        for _ in range(RIGS):
            draws = generator.uniform(-1.0, 1.0, len(moved))
            rigs.append(named({**values, **{
                one.name: float(np.clip(one.value(one.prior_deviation * draw), one.lower, one.upper))
                for one, draw in zip(moved, draws, strict=True)
            }}))  # fmt: skip
        return cls(model, limits, tuple(rigs))

    @property
    def most(self) -> dict[str, float]:
        """The largest share of each limit that any of the rigs reaches."""
        return {name: max(each[name] for each in self.shares) for name in self.shares[0]}

    def reached(self, voltages: Array, times: Array) -> Margins:
        """The same with the shares that a test reaches with these voltages [V], held from these times [s] on."""
        shares, bands = [], dict[str, list[Array]]()
        for rows, columns in self._motions(voltages, times):
            shares += [self._shares(one) for one in rows]
            for name in ("position", "velocity", "pressure_a", "pressure_b"):
                bands.setdefault(name, []).extend(rows[:, :, columns.index(name)])
        found = {
            name: np.stack([np.min(every, axis=0), every[0], np.max(every, axis=0)]) for name, every in bands.items()
        }
        time = np.asarray((np.arange(found["position"].shape[1]) + 1) * EVERY * STEPS[0], dtype=np.float64)
        return replace(self, shares=tuple(shares), time=time, bands=found)

    def largest_amplitude(self, make: Callable[[float], CommandSignal], times: Array) -> float:
        """The largest amplitude [V] found at which no rig exceeds a limit; 0 where there is none.

        `make`: the signal of an amplitude. Raises EhaError where a limit is exceeded at rest.
        """
        rest, held = self._worst(0.0 * times[: len(times) // 4], times[: len(times) // 4]), 0.0
        over = {name: float(np.max(share)) for name, share in rest.items() if np.max(share) >= FULL}
        if over:
            name = max(over, key=lambda name: over[name])
            raise EhaError(
                f"{name}: at rest a rig within the priors is at {over[name]:.2f} of the limit; give a wider one"
            )
        largest = min(self.limits.voltage, self._saturation())
        amplitude = FIRST * largest
        for _ in range(PASSES):
            shares = self._worst(make(amplitude).voltage(times), times)
            if max(float(np.max(share)) for share in shares.values()) <= 1.0:
                held = max(held, amplitude)
            grown = [(FULL - rest[name]) / np.maximum(shares[name] - rest[name], 1e-9) for name in shares]
            factor = float(min(np.min(each) for each in grown))
            if held == amplitude and (factor < 1.03 or amplitude >= largest):
                break
            amplitude = min(amplitude * factor, largest)
        return held

    def _saturation(self) -> float:
        return self.model.values["saturation_current"] * self.model.values["coil_resistance"]

    def _worst(self, voltages: Array, times: Array) -> dict[str, Array]:
        """(rigs,) the share of each limit that is reached, by its name."""
        found = [self._shares(one) for rows, _ in self._motions(voltages, times) for one in rows]
        return {name: np.array([each[name] for each in found]) for name in found[0]}

    def _shares(self, rows: Array) -> dict[str, float]:
        return self.limits.shares(rows, EVERY * STEPS[0], self.model.values["atmospheric_pressure"])

    def _motions(self, voltages: Array, times: Array) -> Iterator[tuple[Array, tuple[str, ...]]]:
        """The rigs' rows (rigs, samples, columns), TOGETHER at a time, with the columns' names."""
        period = float(times[1] - times[0])
        command = np.repeat(voltages, round(period / STEPS[0]))
        for first in range(0, len(self.rigs), TOGETHER):
            made = simulate_many(
                self.rigs[first : first + TOGETHER], command, step_size=STEPS[0], every=EVERY,
                composition=self.model.composition,
            )  # fmt: skip
            yield made.values, made.columns
