"""The residuals of the model's equations in a measurement, compared with a simulation of the same command.

With e = measured - simulated, the difference of the two sets of equations, linear in e, is evaluated in its weak form
(see `weighting`). The missing part of an equation then appears in that equation alone, in units of the sensors' noise
in it, and the simulation's initial state cancels out.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eha_core.plant import Trajectory
from eha_core.weak_form.weighting import Weighting, weighting

Array = NDArray[np.float64]

CHANNELS = ("position", "pressure_a", "pressure_b")
EQUATIONS = ("force balance", "chamber A", "chamber B")

_AT_AN_END = 4.0  # of the position's noise: nearer to an end of the stroke the piston may rest against it
_LOWEST_DROP = 1e5  # Pa over an orifice below which its flow is not corrected for the measured pressure


def equation_residuals(
    errors: Mapping[str, Array],
    noises: Mapping[str, float],
    model: Trajectory,
    parameters: Mapping[str, float],
    period: float,
) -> dict[str, Array]:
    """The residual of each of EQUATIONS over time, in units of its noise.

    Args:
        errors: measured minus simulated of each of CHANNELS, (n,).
        noises: standard deviation of each channel's noise.
        model: the simulated rows, n of them, `period` [s] apart.
        parameters: the model's.

    Returns (n - 2 half,) values each, at the centres of the test functions; empty where the rows are shorter than one.
    The force balance is nan where an end of the stroke may push on the piston: with a force that nobody knows.
    """
    test = weighting(period)
    if len(model.time) < len(test.weight):
        return {}
    opens = model.spool_position >= 0.0
    sides = {
        "chamber A": _Side(1.0, "pressure_a", "pressure_b", parameters["piston_area"], model.flow_a, opens),
        "chamber B": _Side(-1.0, "pressure_b", "pressure_a", parameters["piston_area_b"], model.flow_b, ~opens),
    }
    force = _force_residual(errors, noises, parameters, test)
    found = {"force balance": np.where(_touches_an_end(errors, noises, model, parameters, test), np.nan, force)}
    return found | {name: _flow_residual(side, errors, noises, model, parameters, test) for name, side in sides.items()}


class _Side(NamedTuple):
    """One chamber: whether its piston side grows with the position (1) or shrinks (-1), its pressure and the other
    one, its piston area, its port's flow (into A, out of B), and where the valve opens that port to the supply."""

    direction: float
    own: str
    other: str
    area: float
    flow: Array
    is_supplied: NDArray[np.bool_]


def _force_residual(
    errors: Mapping[str, Array], noises: Mapping[str, float], parameters: Mapping[str, float], test: Weighting
) -> Array:
    area_a, area_b = parameters["piston_area"], parameters["piston_area_b"]
    mass, damping, spring = (parameters[name] for name in ("moving_mass", "damping_coefficient", "spring_stiffness"))
    inertia = mass * test.curvature - damping * test.slope + spring * test.weight
    x, a, b = (errors[name] for name in CHANNELS)
    of_x, of_a, of_b = (noises[name] for name in CHANNELS)
    residual = _averaged(area_a * a - area_b * b, test.weight) - _averaged(x, inertia)
    pressed = (area_a * of_a) ** 2 + (area_b * of_b) ** 2
    variance = pressed * np.sum(test.weight**2) + of_x**2 * np.sum(inertia**2)
    return np.asarray(residual / np.sqrt(variance))


def _flow_residual(
    side: _Side, errors: Mapping[str, Array], noises: Mapping[str, float], model: Trajectory,
    parameters: Mapping[str, float], test: Weighting,
) -> Array:  # fmt: skip
    bulk, leak, outside = (parameters[name] for name in ("bulk_modulus", "internal_leakage", "external_leakage"))
    own, growing = errors[side.own], side.direction * side.area
    reach = parameters["actuator_displacement"] + side.direction * model.position
    compressed = (parameters["line_volume"] + side.area * reach) / bulk
    more, slope = _flow_change(side, getattr(model, side.own), own, model)
    moving = growing / bulk * model.velocity
    flow = side.direction * more - leak * (own - errors[side.other]) - outside * own + moving * own
    residual = _averaged(flow, test.weight) + _averaged(growing * errors["position"] + compressed * own, test.slope)
    # a pressure's noise changes the oil's volume and, where much flows, the flow
    gain = side.direction * slope - leak - outside + moving
    of_pressure = (
        _averaged(gain**2, test.weight**2)
        + _averaged(2.0 * gain * compressed, test.weight * test.slope)
        + _averaged(compressed**2, test.slope**2)
    )
    of_position = (side.area * noises["position"]) ** 2 * np.sum(test.slope**2)
    return np.asarray(residual / np.sqrt(noises[side.own] ** 2 * of_pressure + of_position))


def _touches_an_end(
    errors: Mapping[str, Array], noises: Mapping[str, float], model: Trajectory, parameters: Mapping[str, float],
    test: Weighting,
) -> NDArray[np.bool_]:  # fmt: skip
    """Where either piston may rest against an end of the stroke within the test function."""
    farthest = np.maximum(np.abs(model.position), np.abs(model.position + errors["position"]))
    near = farthest > parameters["actuator_displacement"] - _AT_AN_END * noises["position"]
    return np.asarray(_averaged(near.astype(np.float64), np.ones(len(test.weight))) > 0.0)


def _flow_change(side: _Side, pressure: Array, error: Array, model: Trajectory) -> tuple[Array, Array]:
    """The port's flow at the measured pressure minus that at the simulated one, and its derivative by the pressure."""
    drop = np.where(side.is_supplied, model.supply_pressure - pressure, pressure - model.return_pressure)
    sign = np.where(side.is_supplied, -1.0, 1.0)
    least = np.maximum(drop, _LOWEST_DROP)
    flow = np.where(drop > _LOWEST_DROP, side.flow, 0.0)
    return flow * (np.sqrt(np.maximum(1.0 + sign * error / least, 0.0)) - 1.0), sign * flow / (2.0 * least)


def _averaged(values: Array, weight: Array) -> Array:
    return np.asarray(np.correlate(values, weight, mode="valid"), dtype=np.float64)
