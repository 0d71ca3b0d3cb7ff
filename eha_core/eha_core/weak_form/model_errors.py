"""The residuals of the model's equations in a measurement, compared with a simulation of the same command.

With e = measured - simulated, the difference of the two sets of equations, linear in e, is evaluated in its weak form
(see `weighting`). The missing part of an equation then appears in that equation alone, in units of the sensors' noise
in it, and the simulation's initial state cancels out.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from eha_core.plant import Trajectory
from eha_core.weak_form.weighting import weighting

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
    weight, slope, curvature = weighting(period)
    if len(model.time) < len(weight):
        return {}
    x, a, b = (errors[name] for name in CHANNELS)
    bulk, leak, outside = (parameters[name] for name in ("bulk_modulus", "internal_leakage", "external_leakage"))
    area_a, area_b = parameters["piston_area"], parameters["piston_area_b"]
    mass, damping, spring = (parameters[name] for name in ("moving_mass", "damping_coefficient", "spring_stiffness"))
    stroke, line = parameters["actuator_displacement"], parameters["line_volume"]
    volume_a = line + area_a * (stroke + model.position)
    volume_b = line + area_b * (stroke - model.position)
    more_a, more_b = _flow_changes(model, a, b)
    flow_a, flow_b = _flow_slopes(model)
    inertia = mass * curvature - damping * slope + spring * weight
    terms = {
        "force balance": ((weight, area_a * a - area_b * b), (-inertia, x)),
        "chamber A": (
            (weight, more_a - leak * (a - b) - outside * a + area_a / bulk * model.velocity * a),
            (slope, area_a * x + volume_a / bulk * a),
        ),
        "chamber B": (
            (weight, -more_b + leak * (a - b) - outside * b - area_b / bulk * model.velocity * b),
            (slope, -area_b * x + volume_b / bulk * b),
        ),
    }
    of_x, of_a, of_b = (noises[name] for name in CHANNELS)

    def of_chamber(area: float, of_pressure: float, volume: Array, gain: Array) -> Array:
        # a pressure's noise changes both the oil's volume and, where much flows, the flow
        gain, volume = of_pressure * gain, of_pressure * volume / bulk
        pairs = ((gain**2, weight**2), (2.0 * gain * volume, weight * slope), (volume**2, slope**2))
        own = np.stack([np.correlate(*pair, mode="valid") for pair in pairs])
        return np.asarray(np.sum(own, axis=0) + _power(slope, (area * of_x) ** 2))

    leaks = leak + outside
    of_force = _power(weight, (area_a * of_a) ** 2 + (area_b * of_b) ** 2) + _power(inertia, of_x**2)
    variances = {
        "force balance": np.asarray(of_force),
        "chamber A": of_chamber(area_a, of_a, volume_a, flow_a - leaks + area_a / bulk * model.velocity),
        "chamber B": of_chamber(area_b, of_b, volume_b, -flow_b - leaks - area_b / bulk * model.velocity),
    }
    found = {
        name: sum(np.correlate(values, weight, mode="valid") for weight, values in parts) / np.sqrt(variances[name])
        for name, parts in terms.items()
    }
    farthest = np.maximum(np.abs(model.position), np.abs(model.position + x))
    touches = np.convolve(farthest > stroke - _AT_AN_END * of_x, np.ones(len(weight)), mode="valid") > 0.0
    return found | {"force balance": np.where(touches, np.nan, found["force balance"])}


def _flow_changes(model: Trajectory, a: Array, b: Array) -> tuple[Array, Array]:
    """The flows into port A and out of port B at the measured pressures, minus those at the simulated ones."""
    (drop_a, sign_a), (drop_b, sign_b) = _drops(model)
    ratio_a = 1.0 + sign_a * a / np.maximum(drop_a, _LOWEST_DROP)
    ratio_b = 1.0 + sign_b * b / np.maximum(drop_b, _LOWEST_DROP)
    return (
        np.where(drop_a > _LOWEST_DROP, model.flow_a * (np.sqrt(np.maximum(ratio_a, 0.0)) - 1.0), 0.0),
        np.where(drop_b > _LOWEST_DROP, model.flow_b * (np.sqrt(np.maximum(ratio_b, 0.0)) - 1.0), 0.0),
    )


def _flow_slopes(model: Trajectory) -> tuple[Array, Array]:
    """The derivatives of these flows by their own pressures."""
    (drop_a, sign_a), (drop_b, sign_b) = _drops(model)
    return (
        np.where(drop_a > _LOWEST_DROP, sign_a * model.flow_a / (2.0 * np.maximum(drop_a, _LOWEST_DROP)), 0.0),
        np.where(drop_b > _LOWEST_DROP, sign_b * model.flow_b / (2.0 * np.maximum(drop_b, _LOWEST_DROP)), 0.0),
    )


def _drops(model: Trajectory) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """The pressure drop over the orifice of each port, and the sign with which the chamber's own pressure is in it."""
    opens = model.spool_position >= 0.0
    sign = np.where(opens, 1.0, -1.0)
    drop_a = np.where(opens, model.supply_pressure - model.pressure_a, model.pressure_a - model.return_pressure)
    drop_b = np.where(opens, model.pressure_b - model.return_pressure, model.supply_pressure - model.pressure_b)
    return (drop_a, -sign), (drop_b, sign)


def _power(weight: Array, variance: float) -> float:
    return float(np.sum(weight**2)) * variance
