"""LQR on the plant's linearisation, with an integral of the error and a Kalman filter for what no sensor measures."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_discrete_are

from eha_core.control.integrator import Integrator
from eha_core.control.interface import Controller, Measurement, Target
from eha_core.control.linear_model import Array, discretise, reduced

POSITION_ERROR = 3e-3
"""m; the position error that is as bad as VOLTAGE_USED."""

INTEGRAL_ERROR = 0.1e-3
"""m s; likewise of the error's integral."""

VOLTAGE_USED = 0.2
"""V."""

SENSOR_NOISE = (10e-6, 1e-3, 10.0)
"""Standard deviations of position [m], velocity [m/s] and force [N], as the recordings in bags/ have them."""

DISTURBANCE = (0.0, 1e-2, 1e5, 1e-6, 0.0, 1e-5)
"""Standard deviation of what disturbs each state within a period, in the state's unit: assumed. A large one of the load
pressure lets the filter follow a friction that the model does not have."""


class LinearQuadratic(Controller):
    """u = u_r - K (x - x_r) - K_i integral of e, x from the filter, (x_r, u_r) the steady motion at v_r.

    Source: G. F. Franklin, J. D. Powell, M. L. Workman, "Digital Control of Dynamic Systems", Addison-Wesley (1998),
    chapter 9.
    """

    def reset(self) -> None:
        """Forget what was seen."""
        a, b = reduced(self._parameters)
        self._over, self._into = discretise(a, b, self._period)
        area = 0.5 * (self._parameters["piston_area"] + self._parameters["piston_area_b"])
        self._sensors = np.zeros((3, 6))
        self._sensors[[0, 1, 2], [0, 1, 2]] = 1.0, 1.0, area
        self._gain = _feedback(self._over, self._into, self._period)
        self._filter = _filter(self._over, self._sensors)
        self._steady = _steady_motion(a, b)
        self._integral = Integrator(self._period, self._largest)
        self._predicted: Array | None = None

    def voltage(self, measured: Measurement, target: Target) -> float:
        """Return the voltage of the next period [V]."""
        seen = np.array(measured)
        if self._predicted is None:
            self._predicted = np.linalg.pinv(self._sensors) @ seen
        state = self._predicted + self._filter @ (seen - self._sensors @ self._predicted)
        steady = self._steady * target.velocity
        steady[0] = target.position
        deviation = np.append(state - steady[:6], self._integral.value)
        voltage = float(steady[6] - self._gain @ deviation)
        self._integral.add(measured.position - target.position, -voltage)
        voltage = self._limited(voltage)
        self._predicted = self._over @ state + self._into * voltage
        return voltage


def _feedback(over: Array, into: Array, period: float) -> Array:
    """Gains on the six states and the integral of the position error."""
    wider, inputs = np.eye(7), np.zeros((7, 1))
    wider[:6, :6], inputs[:6, 0] = over, into
    wider[6, 0] = period
    state_cost, input_cost = np.zeros((7, 7)), np.array([[VOLTAGE_USED**-2]])
    state_cost[0, 0], state_cost[6, 6] = POSITION_ERROR**-2, INTEGRAL_ERROR**-2
    cost = solve_discrete_are(wider, inputs, state_cost, input_cost)
    gain: Array = np.linalg.solve(input_cost + inputs.T @ cost @ inputs, inputs.T @ cost @ wider)[0]
    return gain


def _filter(over: Array, sensors: Array) -> Array:
    """The steady Kalman gain that corrects a prediction by the newest measurement."""
    noise = np.diag(np.square(SENSOR_NOISE))
    spread = solve_discrete_are(over.T, sensors.T, np.diag(np.square(DISTURBANCE)), noise)
    gain: Array = spread @ sensors.T @ np.linalg.inv(sensors @ spread @ sensors.T + noise)
    return gain


def _steady_motion(a: Array, b: Array) -> Array:
    """States and voltage of a steady motion at 1 m/s through mid stroke: all derivatives zero but the position's."""
    unknown = np.column_stack([a[1:, 1:], b[1:]])
    motion = np.zeros(7)
    motion[1] = 1.0
    motion[2:] = np.linalg.lstsq(unknown[:, 1:], -unknown[:, 0], rcond=None)[0]
    return motion
