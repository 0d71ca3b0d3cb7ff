"""Families of rigs that the exam draws its plants from, and what a plant's valve and stroke allow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eha_exam.truth.record import PLANT

UNCERTAIN = ("valve_gain", "bulk_modulus", "damping_coefficient", "internal_leakage", "moving_mass", "spring_stiffness")
"""What a data sheet gives only roughly: the nominal values of these are off where a tier says so."""

RIG_MISTAKES = ("supply_pressure", "valve_natural_frequency", "valve_damping_ratio", "coil_inductance")
"""What an engineer takes from a label or another valve's data sheet and may have wrong."""

FAMILIES: dict[str, dict[str, tuple[float, float]]] = {
    "light_servo": {"moving_mass": (7.0, 12.0), "damping_coefficient": (1500.0, 2500.0)},
    "heavy_press": {
        "moving_mass": (130.0, 170.0),
        "damping_coefficient": (3000.0, 6000.0),
        "spring_stiffness": (2e4, 1e5),
        "piston_area": (1.8e-3, 2.2e-3),
        "supply_pressure": (1.0e7, 1.4e7),
        "actuator_displacement": (0.12, 0.18),
        "valve_gain": (3.5e-5, 4.5e-5),
        "line_volume": (3e-5, 6e-5),
        "valve_natural_frequency": (350.0, 450.0),
        "valve_damping_ratio": (0.6, 0.8),
        "internal_leakage": (2e-12, 8e-12),
    },
    "single_rod": {
        "moving_mass": (25.0, 40.0),
        "damping_coefficient": (1500.0, 3000.0),
        "piston_area": (1.1e-3, 1.4e-3),
        "supply_pressure": (1.4e7, 1.8e7),
        "actuator_displacement": (0.12, 0.2),
        "line_volume": (1e-5, 3e-5),
        "internal_leakage": (1e-12, 5e-12),
    },
    "low_pressure": {
        "moving_mass": (4.0, 8.0),
        "damping_coefficient": (700.0, 1200.0),
        "piston_area": (4.5e-4, 6e-4),
        "supply_pressure": (4e6, 7e6),
        "valve_gain": (4e-5, 6e-5),
        "bulk_modulus": (0.9e9, 1.3e9),
        "line_volume": (1e-5, 2e-5),
        "internal_leakage": (2e-12, 1e-11),
    },
}
"""Ranges of what differs from Table 1 in each family (assumed: catalogue sizes of such rigs)."""

ROD_RATIO = (0.55, 0.75)
"""Area of the rod side over that of the head side, single-rod cylinders."""


@dataclass(frozen=True)
class Rig:
    """A plant and the figures a test is planned with."""

    family: str
    values: Mapping[str, float]

    @property
    def area_ratio(self) -> float:
        """A_b / A_a."""
        return self.values["piston_area_b"] / self.values["piston_area"]

    @property
    def stall_force(self) -> float:
        """A_a P_s [N]."""
        return self.values["piston_area"] * self.values["supply_pressure"]

    def speed_per_ampere(self, direction: float) -> float:
        """Steady speed of the unloaded piston per ampere of spool, extending or retracting [m/(s A)]."""
        ratio = self.area_ratio
        share = (1.0 if direction > 0.0 else ratio) / (1.0 + ratio**3)
        root = np.sqrt(share * self.values["supply_pressure"])
        return float(self.values["valve_gain"] * root / self.values["piston_area"])

    @property
    def top_speed(self) -> float:
        """Steady speed at the saturation current, the slower direction [m/s]."""
        return self.values["saturation_current"] * min(self.speed_per_ampere(1.0), self.speed_per_ampere(-1.0))


def draw_rig(family: str, generator: np.random.Generator) -> Rig:
    """A random rig of a family."""
    values = dict(PLANT)
    for name, (low, high) in FAMILIES[family].items():
        values[name] = float(np.exp(generator.uniform(np.log(low), np.log(high))))
    ratio = generator.uniform(*ROD_RATIO) if family == "single_rod" else 1.0
    values["piston_area_b"] = values["piston_area"] * ratio
    return Rig(family, values)


def draw_nominal(rig: Rig, generator: np.random.Generator, error: float, mistakes: bool) -> dict[str, float]:
    """What the diagnosis is given: uncertain values off by up to `error`, with `mistakes` those of the label too."""
    nominal = {name: value for name, value in rig.values.items() if name != "transition_pressure"}
    for name in UNCERTAIN:
        nominal[name] *= float(1.0 + generator.uniform(-error, error))
    if mistakes:
        for name in RIG_MISTAKES:
            nominal[name] *= float(1.0 + generator.uniform(-0.15, 0.15))
    return nominal
