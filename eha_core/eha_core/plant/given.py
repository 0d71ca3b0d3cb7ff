"""What the compiled step does with its input where that is measured: in place of `source`.

Inputs are an array (steps, 2), each row held over its step. The last two parameters of such a plant's vector say what
moves the spool (`VALVES`) and which source delivers; `composite` writes the function `ports`, which asks that one.
"""

from __future__ import annotations

from eha_core.compiled import inlined
from eha_core.plant.scheme import spool_step

VALVES = {"": 0.0, "spool": 0.0, "current": 1.0}
"""How much of the valve stands between input and ports: nothing, or equation (2)."""


@inlined
def given_at(inputs, index):
    """What is given for a step."""
    return inputs[index, 0], inputs[index, 1]


@inlined
def voltage_of(given):
    """There is none."""
    return 0.0


@inlined
def current_of(voltage, given, current, propagator, parameters):
    """The current is what is given first, if it is one."""
    return given[0]


@inlined
def spool_of(given, position, velocity, target, new_target, propagator, parameters):
    """Equation (2) under a held current, or the spool where it was measured, over the whole step."""
    if parameters[-2] > 0.0:
        new_position, new_velocity = spool_step(position, velocity, target, new_target, propagator[2:])
        return position, new_position, new_velocity
    return given[0], given[0], 0.0
