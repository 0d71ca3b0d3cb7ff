"""The equations' residuals with the measured channels, without simulation: the weak form.

Each equation is multiplied by a test function in time and integrated by parts, so that derivatives act on the test
function and no measured channel is differentiated. Its coefficients are regressed; what remains is the equation's
residual. A wrong flow equation does not affect the force equation's residual, and vice versa, so that the residuals
show which equation is wrong before any hypothesis is made. After D. A. Messenger and D. M. Bortz, "Weak SINDy",
Multiscale Modeling & Simulation 19 (2021).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.observation import Observation
from eha_core.identification.segments import smooth
from eha_core.identification.shooting import Shooting
from eha_core.plant import COLUMNS
from eha_core.weak_form.grid import Grid, make_grid

SPEED_SPAN = 0.04
"""s over which the position is smoothed for the speed that laws depend on."""

EQUATIONS = ("force", "continuity_a", "continuity_b")


@dataclass(frozen=True)
class EquationResidual:
    """The missing part of one equation, averaged with each test function.

    Attributes:
        equation: one of EQUATIONS.
        time: (n,) of the test functions' centres [s].
        missing: (n,) the force on the piston [N], or the flow into the chamber [m^3/s], that its terms do not explain.
        noise: standard deviation of `missing` due to the sensors' noise.
        terms: (n, k) the terms whose coefficients were regressed; `missing` is orthogonal to them.
        grid: the grid and its test functions.
        states: position [m], velocity [m/s], pressure difference [Pa], spool position [A] and time [s] on the grid,
            and in a chamber's equation the `flow_an_ampere` of opening [m^3/(s A)] into it.
    """

    equation: str
    time: Array
    missing: Array
    noise: float
    terms: Array
    grid: Grid
    states: Mapping[str, Array]

    @property
    def residual(self) -> Array:
        """(n,) the missing part in units of its noise."""
        freedom = max(1, len(self.missing) - self.terms.shape[1])
        return np.asarray(self.missing / self.noise * np.sqrt(len(self.missing) / freedom))

    @property
    def chi_square(self) -> float:
        """Per degree of freedom: 1 where the equation holds."""
        return float(np.mean(self.residual**2)) if len(self.missing) else 0.0


def smallest(alternatives: Sequence[tuple[EquationResidual, ...]]) -> tuple[EquationResidual, ...]:
    """Of residuals with several models, the smallest of the force equation and the smallest pair of continuities.

    The quantities that are not regressed (areas, pressures of the lines, stroke, the valve's motion) are the model's.
    Fitted values are right if no physics is missing, and may be biased otherwise.
    """
    found = [residuals for residuals in alternatives if residuals]
    if not found:
        return ()
    force = min((residuals[0] for residuals in found), key=lambda residual: residual.chi_square)
    return (
        force,
        *min((residuals[1:] for residuals in found), key=lambda pair: sum(residual.chi_square for residual in pair)),
    )


def equation_residuals(observation: Observation, shooting: Shooting, model: Fit) -> tuple[EquationResidual, ...]:
    """The residual of every equation whose channels were measured; empty without position or a pressure."""
    pressure_a, pressure_b = observation.channel("pressure_a"), observation.channel("pressure_b")
    position = observation.channel("position")
    if position is None or pressure_a is None or pressure_b is None:
        return ()
    spacing = max(float(np.median(np.diff(channel.time))) for channel in (position, pressure_a, pressure_b))
    grid = make_grid(observation.duration, spacing, (position, pressure_a, pressure_b))
    rows, _ = shooting.simulate(model.values, model.states, full=True)
    row_times = (np.arange(len(rows)) + 1) * shooting.step_size * shooting.every
    a = np.interp(grid.time, pressure_a.time, pressure_a.values)
    b = np.interp(grid.time, pressure_b.time, pressure_b.values)
    states = {
        "position": np.interp(grid.time, position.time, position.values),
        "velocity": np.interp(grid.time, position.time, smooth(position, 1, SPEED_SPAN)),
        "pressure difference": a - b,
        "spool position": np.interp(grid.time, row_times, rows[:, COLUMNS.index("spool_position")]),
        "time": grid.time,
    }
    leaked = sum((np.where(grid.time >= time, change, 0.0) * (a - b) for time, change in observation.leakage), 0.0 * a)
    noises = (position.noise, pressure_a.noise, pressure_b.noise)
    entering: dict[str, Array | None] = {"a": None, "b": None}
    if not observation.composition.source.valve:
        entering["a"] = np.interp(grid.time, row_times, rows[:, COLUMNS.index("flow_a")])
        entering["b"] = -np.interp(grid.time, row_times, rows[:, COLUMNS.index("flow_b")])
    return (
        force_residual(grid, states, a, b, noises, model.values),
        *(
            continuity_residual(grid, states, side, a, b, noises, model.values, leaked, entering[side])
            for side in ("a", "b")
        ),
    )


def _regressed(
    grid: Grid, equation: str, left: Array, columns: list[Array], noise: float, states: Mapping[str, Array]
) -> EquationResidual:
    """The residual of an equation whose left side and terms were integrated with each test function."""
    matrix = np.stack(columns, axis=1)
    scale = np.linalg.norm(matrix, axis=0)
    matrix = matrix / np.where(scale > 0.0, scale, 1.0)
    solution, *_ = np.linalg.lstsq(matrix, left, rcond=None)
    missing = (left - matrix @ solution) / grid.area
    return EquationResidual(equation, grid.centres()[: len(left)], missing, noise / grid.area, matrix, grid, states)


def force_residual(
    grid: Grid,
    states: Mapping[str, Array],
    a: Array,
    b: Array,
    noises: tuple[float, ...],
    values: Mapping[str, float],
) -> EquationResidual:
    """The piston's: the missing force is M x'' + B x' + K x - (A_a P_a - A_b P_b), with free coefficients.

    `a` and `b`: pressures on the grid [Pa]; `noises`: of position [m] and of both pressures [Pa].
    """
    x, area_a, area_b = states["position"], values["piston_area"], values["piston_area_b"]
    left = grid.integrate(grid.weight, area_b * b - area_a * a)
    columns = [grid.integrate(grid.curvature, x), -grid.integrate(grid.slope, x), grid.integrate(grid.weight, x)]
    position_weight = (
        values["moving_mass"] * grid.curvature
        - values["damping_coefficient"] * grid.slope
        + values["spring_stiffness"] * grid.weight
    )
    variance = float(np.sum(grid.weight**2)) * ((area_a * noises[1]) ** 2 + (area_b * noises[2]) ** 2)
    variance += float(np.sum(position_weight**2)) * noises[0] ** 2
    return _regressed(grid, "force", left, columns, float(np.sqrt(variance)) * grid.step, states)


def continuity_residual(
    grid: Grid,
    states: Mapping[str, Array],
    side: str,
    a: Array,
    b: Array,
    noises: tuple[float, ...],
    values: Mapping[str, float],
    leaked: Array | None = None,
    given: Array | None = None,
) -> EquationResidual:
    """A chamber's: the missing flow is the swept flow minus the valve's flow, compression and leakage.

    `leaked`: the flow from chamber A to B [m^3/s] of a leak that was opened while recording. `given`: the flow into the
    chamber [m^3/s] where no valve's spool determines it.
    """
    x, speed, spool = states["position"], states["velocity"], states["spool position"]
    sign = 1.0 if side == "a" else -1.0
    own, noise = (a, noises[1]) if side == "a" else (b, noises[2])
    area = values["piston_area"] if side == "a" else values["piston_area_b"]
    volume = values["line_volume"] + area * (values["actuator_displacement"] + sign * x)
    left = -sign * area * grid.integrate(grid.slope, x)
    if leaked is not None:
        left = left + sign * grid.integrate(grid.weight, leaked)
    filling = np.where(sign * spool >= 0.0, values["supply_pressure"] - own, own - values["return_pressure"])
    flow_an_ampere = sign * values["valve_gain"] * np.sqrt(np.maximum(filling, 0.0))
    entering = flow_an_ampere * spool if given is None else given
    # V dP/dt integrates by parts to -(slope V + weight dV/dt) P
    squeezed = -(grid.integrate(grid.slope, volume * own) + grid.integrate(grid.weight, sign * area * speed * own))
    columns = [grid.integrate(grid.weight, entering), squeezed, grid.integrate(grid.weight, a - b)]
    weight = grid.slope * float(np.mean(volume)) / values["bulk_modulus"]
    variance = float(np.sum(weight**2)) * noise**2 + float(np.sum(grid.slope**2)) * (area * noises[0]) ** 2
    noise = float(np.sqrt(variance)) * grid.step
    return _regressed(grid, f"continuity_{side}", left, columns, noise, {**states, "flow_an_ampere": flow_an_ampere})
