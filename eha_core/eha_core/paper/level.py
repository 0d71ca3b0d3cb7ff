"""One level of internal leakage: the displacement, its error against the leakage-free one, and its row of Table 3."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_core.paper.printed import LEVELS, PRINTED_RMSE
from eha_core.parameters import nominal_values

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Level:
    """A record under one leakage coefficient [m^3/(s Pa)]; lengths in m, times in s, arrays of one shape (n,).

    `reference` is the displacement without internal leakage, `closed_form` the small-signal prediction of `rmse`, and
    `printed` the paper's value.
    """

    internal_leakage: float
    time: Array
    displacement: Array
    reference: Array
    rmse: float
    closed_form: float
    printed: float

    @property
    def error(self) -> Array:
        """Displacement minus the leakage-free one."""
        return self.displacement - self.reference

    @property
    def ratio(self) -> float:
        """Computed over printed."""
        return self.rmse / self.printed


@dataclass(frozen=True)
class Sweep:
    """Figure 5: RMSE [m] and its closed form [m] over internal leakage [m^3/(s Pa)], arrays of one shape (n,)."""

    internal_leakage: Array
    rmse: Array
    closed_form: Array


def root_mean_square(values: Array) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def closed_form(internal_leakage: float, reference_rms: float, parameters: Mapping[str, float] | None = None) -> float:
    """Return the small-signal RMSE [m]: k / (1 + k) times the RMS of the leakage-free displacement [m].

    k = K_Lin B_s / A_p^2. Of the flow Q that the valve meters, A_p v moves the piston, and the pressure that overcomes
    its damping, B_s v / A_p, drives K_Lin B_s v / A_p past the seal; so leakage divides the displacement by 1 + k.
    Spring and inertia are neglected, and so is the valve's flow falling with the load pressure.
    """
    values = nominal_values() | dict(parameters or {})
    k = internal_leakage * values["damping_coefficient"] / values["piston_area"] ** 2
    return k / (1.0 + k) * reference_rms


def measure(
    internal_leakage: float,
    time: Array,
    displacement: Array,
    reference: Array,
    parameters: Mapping[str, float] | None = None,
) -> Level:
    """Take a level's figures from a record, simulated or recorded; the level must be one of Table 2."""
    return Level(
        internal_leakage=internal_leakage,
        time=time,
        displacement=displacement,
        reference=reference,
        rmse=root_mean_square(displacement - reference),
        closed_form=closed_form(internal_leakage, root_mean_square(reference), parameters),
        printed=PRINTED_RMSE[LEVELS.index(internal_leakage)],
    )
