"""What the compiled step does with its input: here under the paper's servo valve, driven by a voltage.

`given` has functions of these names and heads for the sources whose input is measured; `composite` compiles the step
once with the one and, where such a plant is asked for, once with the other.
"""

from __future__ import annotations

from eha_core.compiled import inlined
from eha_core.plant.parts.sources.servo_valve import contribution
from eha_core.plant.scheme import coil_current, spool_step
from eha_core.plant.vector import SATURATION_CURRENT


@inlined
def given_at(inputs, index):
    """What is given for a step."""
    return inputs[index]


@inlined
def voltage_of(given):
    """The voltage in what is given."""
    return given


@inlined
def current_of(voltage, given, current, propagator, parameters):
    """Equation (1) over one step."""
    return coil_current(current, voltage, propagator[0], propagator[1], parameters[SATURATION_CURRENT])


@inlined
def spool_of(given, position, velocity, target, new_target, propagator, parameters):
    """Equation (2) over one step: where the spool stands as the step begins; position and velocity at its end."""
    new_position, new_velocity = spool_step(position, velocity, target, new_target, propagator[2:])
    return position, new_position, new_velocity


@inlined
def ports(given, opening, gain, conductance, pressure_a, pressure_b, supply_pressure, return_pressure, parameters):
    """Equation (3): see `scheme.port_flows`."""
    return contribution(opening, gain, conductance, 0.0, 0.0, pressure_a, pressure_b, supply_pressure, return_pressure)


@inlined
def fed(
    tau, given, flows, chambers, spool_position, position, velocity, pressure_a, pressure_b, supply_pressure,
    return_pressure, parameters,
):  # fmt: skip
    """The ports' flows and the supply's pressure over the time tau: a servo valve's supply holds its pressure."""
    return flows, supply_pressure


@inlined
def supply_in_force(supply_pressure, stated, parameters):
    """The supply's pressure for the next step: as the hook `supply` states it."""
    return stated
