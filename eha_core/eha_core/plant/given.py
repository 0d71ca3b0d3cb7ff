"""What the compiled step does with its input where that is measured: in place of `source`.

Inputs are an array (steps, 2), each row held over its step. The last three parameters of such a plant's vector say
whether the pressure at the valve's supply port is a state, what moves the spool (`VALVES`) and which source delivers;
`composite` writes the functions `ports` and `fed`, which ask that one.
"""

from __future__ import annotations

from eha_core.compiled import inlined
from eha_core.plant.equations import external_leakage_flow, orifice_root, volumes
from eha_core.plant.scheme import spool_step
from eha_core.plant.vector import (
    ACTUATOR_DISPLACEMENT,
    ATMOSPHERIC_PRESSURE,
    BULK_MODULUS,
    LINE_VOLUME,
    PISTON_AREA,
)

VALVES = {"": 0.0, "spool": 0.0, "current": 1.0, "sign": 2.0}
"""What stands between input and ports: nothing; or equation (2), under a current or under a sign."""


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
    """The current is what is given first, if it is one; under a sign the spool goes to 1, 0 or -1."""
    if parameters[-2] > 1.0:
        return 1.0 if given[1] > 0.0 else -1.0 if given[1] < 0.0 else 0.0
    return given[0]


@inlined
def spool_of(given, position, velocity, target, new_target, propagator, parameters):
    """Equation (2) under a held current or sign, or the spool where it was measured, over the whole step."""
    if parameters[-2] > 0.0:
        new_position, new_velocity = spool_step(position, velocity, target, new_target, propagator[2:])
        return position, new_position, new_velocity
    return given[0], given[0], 0.0


@inlined
def supply_in_force(supply_pressure, stated, parameters):
    """The supply's pressure for the next step: its own state where the source has a line, else as stated."""
    return supply_pressure if parameters[-3] > 0.0 else stated


@inlined
def port_step(tau, gain, line_pressure, pressure, given_in, fall, line_yields, yields, leaving):
    """An open port between a line and a chamber over the time tau, both pressures implicit, the port by its chord,
    through which no step passes the balance: the mean flow, and both pressures at the end.

    given_in, fall: flow into the line and how much less it is for each pascal there. line_yields, yields: beta / V of
    line and chamber. leaving: what flows out of the chamber elsewhere.
    """
    difference = line_pressure - pressure
    root, slope = orifice_root(difference)
    chord = gain * (root / difference if abs(difference) > 1.0 else slope)
    gives, takes = tau * line_yields / (1.0 + tau * line_yields * fall), tau * yields
    through = chord * (difference + gives * given_in + takes * leaving) / (1.0 + chord * (gives + takes))
    return through, line_pressure + gives * (given_in - through), pressure + takes * (through - leaving)


@inlined
def through_line(
    tau, feed, flows, chambers, spool_position, position, velocity, pressure_a, pressure_b, line_pressure, parameters
):
    """The ports' flows over the time tau, and the pressure at its end of the line that feeds the open port.

    V_l / beta P' = Q - q, with Q what the source gives and q what flows through the port, beside (4) or (5): one
    `port_step`, extrapolated from two of half its length to second order. The chamber takes the same q that the line
    gave: no oil is lost.

    feed: flow into the line, how much less it is for each pascal there, the line's volume.
    """
    given_in, fall, volume = feed
    flow_a, flow_b, fall_a, rise_b, drawn, returned = flows
    area_b, bulk_a, _, bulk_b, _, cross, _, leak_a, leak_b = chambers
    volume_a, volume_b = volumes(
        position, parameters[PISTON_AREA], area_b, parameters[ACTUATOR_DISPLACEMENT], parameters[LINE_VOLUME]
    )
    extending = spool_position > 0.0
    pressure, rise = (pressure_a, fall_a) if extending else (pressure_b, rise_b)
    yields = bulk_a / volume_a if extending else bulk_b / volume_b
    leaving = (
        parameters[PISTON_AREA] * velocity + cross + external_leakage_flow(leak_a, pressure_a) if extending
        else external_leakage_flow(leak_b, pressure_b) - area_b * velocity - cross
    )  # fmt: skip
    gain = rise / orifice_root(line_pressure - pressure)[1]
    line_yields = parameters[BULK_MODULUS] / volume
    whole, at_once, _ = port_step(tau, gain, line_pressure, pressure, given_in, fall, line_yields, yields, leaving)
    first, middle, middle_pressure = port_step(
        0.5 * tau, gain, line_pressure, pressure, given_in, fall, line_yields, yields, leaving
    )
    second, in_two, _ = port_step(
        0.5 * tau, gain, middle, middle_pressure, given_in - fall * (middle - line_pressure), fall, line_yields, yields,
        leaving,
    )  # fmt: skip
    through = first + second - whole
    line_pressure = max(-parameters[ATMOSPHERIC_PRESSURE], 2.0 * in_two - at_once)
    if extending:
        return (through, flow_b, 0.0, rise_b, through, returned), line_pressure
    return (flow_a, -through, fall_a, 0.0, through, returned), line_pressure
