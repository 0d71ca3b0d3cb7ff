"""A case of the exam: the recording that is made and the answer to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eha_exam.concealed import SITES, Setting
from eha_exam.plants import Rig
from eha_exam.truth.record import OUTSIDE, Effect

Array = NDArray[np.float64]
Arrays = dict[str, tuple[Array, Array]]
"""Channel name -> (time [s], value in SI; pressures gauge)."""

POSITION_NOISE = 10e-6
"""m, standard deviation at noise 1x."""
PRESSURE_NOISE = 0.01e6
"""Pa, standard deviation at noise 1x."""


@dataclass(frozen=True)
class Case:
    """One recording of the exam and the answer to it.

    Attributes:
        name: tier and number. tier: one of TIERS. family: of plants.FAMILIES. seed: what it was drawn from.
        plant: the truth's values. nominal: what the diagnosis is given, by the same names.
        effects: what is concealed, (id, parameters). windows: time spans [s] of effects that act over an interval.
        shape, amplitude [m], speed [m/s], loop [rad/s], loop_integral [1/s^2]: the test; loop 0 is an open loop.
        duration [s], rate [1/s]: of the recording. noise: multiple of 10 um and 0.01 MPa.
        position_step [m], pressure_step [Pa]: resolution of the sensors, 0 for none. jitter [s]: standard deviation of
        the sampling times. dropout: share of samples lost, in bursts. channels: what was recorded.
        decidable: whether an oracle that knows the concealed form gains enough from this recording to name it; of
        several effects, each beside all the others. seen: of several effects, those that can be named beside the
        others.
        rivals: effects that this recording cannot tell from the concealed one.
        loads [N]: the constant load in each further recording of the same rig.
    """

    name: str
    tier: str
    family: str
    seed: int
    plant: Mapping[str, float]
    nominal: Mapping[str, float]
    effects: tuple[Effect, ...]
    windows: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    shape: str = "multisine"
    amplitude: float = 0.03
    speed: float = 0.1
    loop: float = 0.0
    loop_integral: float = 0.0
    duration: float = 20.0
    rate: float = 1000.0
    noise: float = 1.0
    position_step: float = 0.0
    pressure_step: float = 0.0
    jitter: float = 0.0
    dropout: float = 0.0
    channels: tuple[str, ...] = ("voltage_command", "position", "pressure_a", "pressure_b")
    decidable: bool = True
    rivals: tuple[str, ...] = ()
    seen: tuple[str, ...] = ()
    loads: tuple[float, ...] = ()

    @property
    def setting(self) -> Setting:
        """What the size of an effect is measured against."""
        return Setting(Rig(self.family, self.plant), self.amplitude, self.speed, self.duration)

    @property
    def effect_ids(self) -> tuple[str, ...]:
        """Ids of what is concealed."""
        return tuple(name for name, _ in self.effects)

    @property
    def sites(self) -> tuple[str, ...]:
        """Sites of what is concealed."""
        return tuple(SITES[name] for name in self.effect_ids)

    @property
    def verdict(self) -> str:
        """The verdict that is right if the recording holds enough to tell."""
        if any(name in OUTSIDE for name in self.effect_ids):
            return "unknown_physics"
        if self.effects:
            return "missing_physics"
        return "parameters" if self.tier == "null_parameters" else "consistent"
