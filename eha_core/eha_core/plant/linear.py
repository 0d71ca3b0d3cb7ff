"""The nominal plant linearised, for controller design."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from eha_core.errors import ParameterError
from eha_core.plant.continuous import nominal_equations, nominal_rates
from eha_core.plant.equations import orifices, volumes
from eha_core.plant.state import State

Array = NDArray[np.float64]

OUTPUTS = ("position", "velocity", "pressure_a", "pressure_b")
"""What a rig measures."""

AT_REST = 1e-9
"""A motion is steady when each rate is this small a part of that under full supply pressure or full flow (assumed)."""


@dataclass(frozen=True)
class LinearPlant:
    """dx/dt = A x + B u + drift, y = C x + D u, in deviations from the operating point; SI units.

    Attributes:
        A, B, C, D: (7, 7), (7, 1), (outputs, 7), (outputs, 1).
        states: the fields of `State`. inputs: the voltage. outputs: OUTPUTS.
        operating_point: the state in which the plant is linearised. voltage: that holds its spool there [V].
        drift: the state's derivative there. It is zero but for the position, where the piston moves steadily, and the
            pressures, where oil leaks from chambers that a shut valve does not refill.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    operating_point: State
    voltage: float
    drift: State


def linearise(
    parameters: Mapping[str, float] | None = None, position: float = 0.0, opening: float = 0.0
) -> LinearPlant:
    """The nominal equations to first order about a piston at rest, or in steady motion.

    With the valve shut (`opening` 0) the piston rests, its chambers' pressures carry the spring, and the pressure drops
    over the two ports are alike; a flow gain is there the mean of those of either direction. With the valve open the
    piston passes `position` at the speed and the pressures at which these stand still.

    Args:
        parameters: what differs from the nominal parameters, by name, in SI units.
        position: of the piston [m]. opening: of the spool [A].

    Raises ParameterError as `derivatives` does, for an opening that the current does not reach, or where no steady
    state has both pressures between return and supply.

    Flow gain and flow-pressure coefficient as in H. E. Merritt, "Hydraulic Control Systems" (1967), chapter 5.
    """
    values = nominal_equations(parameters)
    limit = values["saturation_current"]
    if not abs(opening) < limit:
        raise ParameterError(f"opening = {opening:g} A is out of reach; give less than the {limit:g} A of saturation")
    voltage = opening * values["coil_resistance"]
    position, opening = float(position), float(opening)
    point = _resting(values, position) if opening == 0.0 else _moving(values, position, opening)
    lines = values["return_pressure"], values["supply_pressure"]
    if not all(lines[0] <= pressure <= lines[1] for pressure in (point.pressure_a, point.pressure_b)):
        raise ParameterError(
            f"no steady state at position = {position:g} m and opening = {opening:g} A has its pressures between "
            "return and supply; give a smaller opening or position, a softer spring, or less leakage"
        )
    drift = nominal_rates(point, voltage, values)
    select = np.zeros((len(OUTPUTS), len(State._fields)))
    for row, name in enumerate(OUTPUTS):
        select[row, State._fields.index(name)] = 1.0
    gain = np.zeros((len(State._fields), 1))
    gain[State._fields.index("current")] = 1.0 / values["coil_inductance"]
    return LinearPlant(
        _jacobian(point, drift, values), gain, select, np.zeros((len(OUTPUTS), 1)), State._fields, ("voltage",),
        OUTPUTS, point, voltage, drift,
    )  # fmt: skip


def _resting(values: Mapping[str, float], position: float) -> State:
    """A_p P1 - A_b P2 = K_s x_p with P_s - P1 = P2 - P_r."""
    area_a, area_b = values["piston_area"], values["piston_area_b"]
    total = values["supply_pressure"] + values["return_pressure"]
    pressure_a = (area_b * total + values["spring_stiffness"] * position) / (area_a + area_b)
    return State(0.0, 0.0, 0.0, position, 0.0, pressure_a, total - pressure_a)


def _moving(values: Mapping[str, float], position: float, opening: float) -> State:
    """The steady motion at that opening: velocity and both pressures at which velocity and pressures stand still."""
    rest = _resting(values, position)
    voltage = opening * values["coil_resistance"]
    span = values["supply_pressure"] - values["return_pressure"]
    flow = values["valve_gain"] * opening * np.sqrt(0.5 * span)
    scale = np.array([flow / values["piston_area"], span, span])
    guess = np.array([flow / values["piston_area"], rest.pressure_a, rest.pressure_b]) / scale
    volume_a, volume_b = volumes(
        position, values["piston_area"], values["piston_area_b"], values["actuator_displacement"],
        values["line_volume"],
    )  # fmt: skip
    filling = values["bulk_modulus"] * abs(flow)
    largest = np.array([values["piston_area"] * span / values["moving_mass"], filling / volume_a, filling / volume_b])

    def state(unknown: Array) -> State:
        velocity, pressure_a, pressure_b = (unknown * scale).tolist()
        return State(opening, opening, 0.0, position, velocity, pressure_a, pressure_b)

    def unsteady(unknown: Array) -> Array:
        rate = nominal_rates(state(unknown), voltage, values)
        return np.asarray([rate.velocity, rate.pressure_a, rate.pressure_b] / largest)

    found = root(unsteady, guess, method="hybr", tol=1e-12)
    if not np.max(np.abs(unsteady(found.x))) < AT_REST:
        raise ParameterError(f"no steady motion at position = {position:g} m and opening = {opening:g} A was found")
    return state(found.x)


def _flow_slopes(point: State, values: Mapping[str, float]) -> tuple[float, float, float, float]:
    """dQ1/dx_v, dQ2/dx_v, -dQ1/dP1 and dQ2/dP2 of equation (3); at null the first two are both directions' mean."""
    lines = values["supply_pressure"], values["return_pressure"]
    opening, gain = point.spool_position, values["valve_gain"]
    _, _, fall_a, rise_b = orifices(opening, gain, point.pressure_a, point.pressure_b, *lines)
    sides = (-1.0, 1.0) if opening == 0.0 else (np.sign(opening),)
    gains = [orifices(side, side * gain, point.pressure_a, point.pressure_b, *lines)[:2] for side in sides]
    gain_a, gain_b = np.mean(gains, axis=0)
    return gain_a, gain_b, fall_a, rise_b


def _jacobian(point: State, drift: State, values: Mapping[str, float]) -> Array:
    """The derivative of the equations in the state, row by row."""
    gain_a, gain_b, fall_a, rise_b = _flow_slopes(point, values)
    area_a, area_b = values["piston_area"], values["piston_area_b"]
    volume_a, volume_b = volumes(point.position, area_a, area_b, values["actuator_displacement"], values["line_volume"])
    leak, outside = values["internal_leakage"], values["external_leakage"]
    mass, frequency = values["moving_mass"], values["valve_natural_frequency"]
    square, drag = frequency**2, 2.0 * values["valve_damping_ratio"] * frequency
    # columns: current, spool position and velocity, position, velocity, pressures A and B
    chamber_a = np.array([0, gain_a, 0, 0, -area_a, -fall_a - leak - outside, leak]) * values["bulk_modulus"] / volume_a
    chamber_b = np.array([0, -gain_b, 0, 0, area_b, leak, -rise_b - leak - outside]) * values["bulk_modulus"] / volume_b
    place = State._fields.index("position")
    chamber_a[place] = -drift.pressure_a * area_a / volume_a
    chamber_b[place] = drift.pressure_b * area_b / volume_b
    return np.array(
        [
            [-values["coil_resistance"] / values["coil_inductance"], 0, 0, 0, 0, 0, 0],
            [0, 0, 1, 0, 0, 0, 0],
            [square, -square, -drag, 0, 0, 0, 0],
            [0, 0, 0, 0, 1, 0, 0],
            np.array([0, 0, 0, -values["spring_stiffness"], -values["damping_coefficient"], area_a, -area_b]) / mass,
            chamber_a,
            chamber_b,
        ]
    )
