"""Position controllers for the actuator: laws from measured position, velocity and force to volts, free of ROS.

Each law is a class in a file of its own. `CONTROLLERS` names them; `make_controller` makes one for an actuator.
"""

from __future__ import annotations

from collections.abc import Mapping

from eha_core.control.cascade import Cascade
from eha_core.control.feedforward import Feedforward
from eha_core.control.interface import Controller, Measurement, Target
from eha_core.control.linear_quadratic import LinearQuadratic
from eha_core.control.pid import Pid
from eha_core.control.sliding_mode import SlidingMode
from eha_core.errors import ParameterError

CONTROLLERS: Mapping[str, type[Controller]] = {
    "pid": Pid,
    "cascade": Cascade,
    "lqr": LinearQuadratic,
    "sliding_mode": SlidingMode,
    "feedforward": Feedforward,
}


def make_controller(name: str, parameters: Mapping[str, float], period: float, largest: float) -> Controller:
    """Return a controller by name.

    Args:
        name: one of CONTROLLERS.
        parameters: the actuator's parameters by catalogue name (all of them), as far as they are known.
        period: time between two commands [s].
        largest: largest voltage, either sign [V].
    """
    if name not in CONTROLLERS:
        raise ParameterError(f"controller = {name!r} is unknown; give one of {', '.join(CONTROLLERS)}")
    return CONTROLLERS[name](parameters, period, largest)


__all__ = ["CONTROLLERS", "Controller", "Measurement", "Target", "make_controller"]
