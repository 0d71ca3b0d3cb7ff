"""The paper's equations (1) to (10), each once: what the compiled step is built from, and their time derivative.

Shern, Ghazali, Soon, Sam, Rahmat, "Position Tracking Performance for Electro-Hydraulic Actuator System with the
Presence of Actuator Internal Leakage"; misprints corrected. SI units, pressures above the return line's reference,
current and spool in ampere(-equivalent). `orifice_root` departs from the paper near zero, where its root is infinitely
steep. The stroke's ends are no equation of the paper and stand in `scheme`.
"""

from __future__ import annotations

from math import sqrt

from eha_core.compiled import compiled, inlined

TRANSITION_PRESSURE = 1e4
"""Pa; below about this pressure difference an orifice's flow turns laminar (assumed). It bounds the root's slope."""

TRANSITION_SLOPE = TRANSITION_PRESSURE**-0.5


@inlined
def coil(current, voltage, resistance, inductance, saturation):
    """(1) dI/dt = (V - R_c I) / L_c, but none that would take |I| beyond I_sat."""
    rate = (voltage - resistance * current) / inductance
    return 0.0 if abs(current) >= saturation and rate * current > 0.0 else rate


@inlined
def spool(position, velocity, current, damping_ratio, frequency):
    """(2) x_v'' = w^2 (I - x_v) - 2 xi w x_v'."""
    return frequency * frequency * (current - position) - 2.0 * damping_ratio * frequency * velocity


@inlined
def orifice_root(difference):
    """sign(d) sqrt|d| and its derivative; below the transition the cubic that meets the root there."""
    size = abs(difference)
    if size > TRANSITION_PRESSURE:
        root = sqrt(size)
        return (root if difference > 0.0 else -root), 0.5 / root
    square = (difference / TRANSITION_PRESSURE) ** 2
    return difference * TRANSITION_SLOPE * (1.25 - 0.25 * square), TRANSITION_SLOPE * (1.25 - 0.75 * square)


@inlined
def orifices(opening, gain, pressure_a, pressure_b, supply_pressure, return_pressure):
    """(3) Flow into port A and out of port B; -dQ1/dP1 and dQ2/dP2, by which each chamber's pressure throttles its own.

    x_v >= 0: Q1 = K x_v sqrt(P_s - P1), Q2 = K x_v sqrt(P2 - P_r)
    x_v <  0: Q1 = K x_v sqrt(P1 - P_r), Q2 = K x_v sqrt(P_s - P2)
    """
    extending = opening >= 0.0
    root_a, slope_a = orifice_root(supply_pressure - pressure_a if extending else pressure_a - return_pressure)
    root_b, slope_b = orifice_root(pressure_b - return_pressure if extending else supply_pressure - pressure_b)
    flow = gain * opening
    size = abs(flow)
    return flow * root_a, flow * root_b, size * slope_a, size * slope_b


@inlined
def volumes(position, area_a, area_b, stroke, line):
    """The oil in chambers A and B of (4) and (5): V_line + A_p (x_s + x_p) and V_line + A_b (x_s - x_p)."""
    return line + area_a * (stroke + position), line + area_b * (stroke - position)


@inlined
def net_flows(flow_a, flow_b, cross, outside_a, outside_b, velocity, area_a, area_b):
    """The brackets of (4) and (5): Q1 - q12 - q1 - A_p x_p' and A_b x_p' - Q2 - q21 - q2, with q21 = -q12."""
    return flow_a - cross - outside_a - area_a * velocity, area_b * velocity - flow_b + cross - outside_b


@inlined
def internal_leakage_flow(coefficient, pressure_a, pressure_b):
    """(6)(7) q12 = K_Lin (P1 - P2) = -q21, from chamber A to B."""
    return coefficient * (pressure_a - pressure_b)


@inlined
def external_leakage_flow(coefficient, pressure):
    """(8)(9) q1 = K_Lex P1, q2 = K_Lex P2."""
    return coefficient * pressure


@inlined
def hydraulic_force(area_a, area_b, pressure_a, pressure_b):
    """The pressures' part of (10): A_p P1 - A_b P2."""
    return area_a * pressure_a - area_b * pressure_b


@inlined
def driving_force(hydraulic, spring_stiffness, position):
    """What drives the piston against damping and friction in (10): the pressures' force less K_s x_p."""
    return hydraulic - spring_stiffness * position


@inlined
def piston(driving, velocity, damping_coefficient, mass):
    """(10) x_p'' = (A_p P1 - A_b P2 - K_s x_p - B_s x_p') / M_p; what the paper calls F_f are effects."""
    return (driving - damping_coefficient * velocity) / mass


@compiled
def rates(
    current, spool_position, spool_velocity, position, velocity, pressure_a, pressure_b, voltage,
    coil_resistance, coil_inductance, saturation_current, valve_damping_ratio, valve_natural_frequency, valve_gain,
    bulk_modulus, supply_pressure, return_pressure, spring_stiffness, actuator_displacement, piston_area,
    piston_area_b, moving_mass, damping_coefficient, internal_leakage, external_leakage, line_volume,
):  # fmt: skip
    """The time derivative of the state (its first seven arguments, see `state.State`) in the same order."""
    flow_a, flow_b, _, _ = orifices(
        spool_position, valve_gain, pressure_a, pressure_b, supply_pressure, return_pressure
    )
    net_a, net_b = net_flows(
        flow_a, flow_b, internal_leakage_flow(internal_leakage, pressure_a, pressure_b),
        external_leakage_flow(external_leakage, pressure_a), external_leakage_flow(external_leakage, pressure_b),
        velocity, piston_area, piston_area_b,
    )  # fmt: skip
    volume_a, volume_b = volumes(position, piston_area, piston_area_b, actuator_displacement, line_volume)
    hydraulic = hydraulic_force(piston_area, piston_area_b, pressure_a, pressure_b)
    return (
        coil(current, voltage, coil_resistance, coil_inductance, saturation_current),
        spool_velocity,
        spool(spool_position, spool_velocity, current, valve_damping_ratio, valve_natural_frequency),
        velocity,
        piston(driving_force(hydraulic, spring_stiffness, position), velocity, damping_coefficient, moving_mass),
        bulk_modulus / volume_a * net_a,
        bulk_modulus / volume_b * net_b,
    )
