"""The equations held against the measured channels themselves, without simulating: the weak form.

Each equation is multiplied by a smooth bump in time and integrated; by parts, derivatives fall on the bump and no
measured channel is differentiated. What its coefficients, regressed anew, cannot bring to zero is the equation's
residual. A wrong flow equation leaves the force balance's residual at the noise, and the other way round, so the
residuals tell the equations apart before any hypothesis is made. After D. A. Messenger and D. M. Bortz, "Weak SINDy",
Multiscale Modeling & Simulation 19 (2021).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.facts import Facts
from eha_core.diagnosis.numbers import Array
from eha_core.diagnosis.observation import Observation
from eha_core.diagnosis.shooting import Shooting

HALF_WIDTH = 0.06
"""s; wide enough to average noise, narrow against a reversal's duration."""

EQUATIONS = ("force", "continuity_a", "continuity_b")


@dataclass(frozen=True)
class Balance:
    """One equation's residual: `time` (n,) of the bumps' centres [s], `residual` (n,) in units of its noise."""

    equation: str
    time: Array
    residual: Array

    @property
    def chi_square(self) -> float:
        """Per degree of freedom: 1 where the equation holds."""
        return float(np.mean(self.residual**2)) if len(self.residual) else 0.0


@dataclass(frozen=True)
class _Grid:
    """The channels on one even grid, and the bump with its derivatives on it."""

    time: Array
    step: float
    bump: Array
    slope: Array
    curvature: Array

    def integrate(self, weight: Array, values: Array) -> Array:
        """The integral of weight times values about each bump's centre."""
        sums = np.convolve(values, weight[::-1], mode="valid")[:: len(weight) // 2]
        return np.asarray(sums * self.step)

    def centres(self) -> Array:
        """Times of the bumps' centres."""
        half = len(self.bump) // 2
        return self.time[half : len(self.time) - half][::half]


def _grid(duration: float, step: float) -> _Grid:
    half = max(8, round(HALF_WIDTH / step))
    at = np.arange(-half, half + 1) / half
    inside = 1.0 - at**2
    width = half * step
    bump = inside**4
    slope = -8.0 * at * inside**3 / width
    curvature = (48.0 * at**2 * inside**2 - 8.0 * inside**3) / width**2
    return _Grid(
        np.asarray(np.arange(0.0, duration, step), dtype=np.float64),
        step,
        *(np.asarray(one) for one in (bump, slope, curvature)),
    )


def balances(
    observation: Observation, shooting: Shooting, facts: Facts, values: Mapping[str, float]
) -> tuple[Balance, ...]:
    """The residual of every equation whose channels were measured; none where position or a pressure is missing."""
    pressure_a, pressure_b = observation.channel("pressure_a"), observation.channel("pressure_b")
    position = observation.channel("position")
    if position is None or pressure_a is None or pressure_b is None:
        return ()
    spacing = max(float(np.median(np.diff(one.time))) for one in (position, pressure_a, pressure_b))
    grid = _grid(observation.duration, spacing)
    x = np.interp(grid.time, position.time, position.values)
    a = np.interp(grid.time, pressure_a.time, pressure_a.values)
    b = np.interp(grid.time, pressure_b.time, pressure_b.values)
    noises = (position.noise, pressure_a.noise, pressure_b.noise)
    row_times = (np.arange(len(facts.rows)) + 1) * shooting.step_size * shooting.every
    spool = np.interp(grid.time, row_times, facts.column("spool_position"))
    speed = np.interp(grid.time, row_times, facts.column("velocity"))
    return (
        _force(grid, x, a, b, noises, values),
        *(_continuity(grid, side, x, speed, spool, a, b, noises, values) for side in ("a", "b")),
    )


def _regressed(grid: _Grid, equation: str, left: Array, columns: list[Array], noise: float) -> Balance:
    matrix = np.stack(columns, axis=1)
    scale = np.linalg.norm(matrix, axis=0)
    solution, *_ = np.linalg.lstsq(matrix / np.where(scale > 0.0, scale, 1.0), left, rcond=None)
    residual = left - (matrix / np.where(scale > 0.0, scale, 1.0)) @ solution
    freedom = max(1, len(left) - matrix.shape[1])
    return Balance(equation, grid.centres()[: len(left)], residual / noise * np.sqrt(len(left) / freedom))


def _force(
    grid: _Grid, x: Array, a: Array, b: Array, noises: tuple[float, ...], values: Mapping[str, float]
) -> Balance:
    area_a, area_b = values["piston_area"], values["piston_area_b"]
    left = grid.integrate(grid.bump, area_a * a - area_b * b)
    columns = [grid.integrate(grid.curvature, x), -grid.integrate(grid.slope, x), grid.integrate(grid.bump, x)]
    position_weight = (
        values["moving_mass"] * grid.curvature
        - values["damping_coefficient"] * grid.slope
        + values["spring_stiffness"] * grid.bump
    )
    variance = float(np.sum(grid.bump**2)) * ((area_a * noises[1]) ** 2 + (area_b * noises[2]) ** 2)
    variance += float(np.sum(position_weight**2)) * noises[0] ** 2
    return _regressed(grid, "force", left, columns, float(np.sqrt(variance)) * grid.step)


def _continuity(
    grid: _Grid,
    side: str,
    x: Array,
    speed: Array,
    spool: Array,
    a: Array,
    b: Array,
    noises: tuple[float, ...],
    values: Mapping[str, float],
) -> Balance:
    sign = 1.0 if side == "a" else -1.0
    own, noise = (a, noises[1]) if side == "a" else (b, noises[2])
    area = values["piston_area"] if side == "a" else values["piston_area_b"]
    volume = values["line_volume"] + area * (values["actuator_displacement"] + sign * x)
    left = -sign * area * grid.integrate(grid.slope, x)
    filling = np.where(sign * spool >= 0.0, values["supply_pressure"] - own, own - values["return_pressure"])
    flow = sign * spool * np.sqrt(np.maximum(filling, 0.0))
    # V dP/dt integrates by parts to -(slope V + bump dV/dt) P
    squeezed = -(grid.integrate(grid.slope, volume * own) + grid.integrate(grid.bump, sign * area * speed * own))
    columns = [grid.integrate(grid.bump, flow), squeezed, grid.integrate(grid.bump, a - b)]
    weight = grid.slope * float(np.mean(volume)) / values["bulk_modulus"]
    variance = float(np.sum(weight**2)) * noise**2 + float(np.sum(grid.slope**2)) * (area * noises[0]) ** 2
    return _regressed(grid, f"continuity_{side}", left, columns, float(np.sqrt(variance)) * grid.step)
