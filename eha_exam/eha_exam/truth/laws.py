"""The truth's equations of motion, compiled, in one file so that a cached copy is never older than a law it calls.

State: position, velocity, pressure A, pressure B (gauge), loss of supply pressure (under a pump, of its line's), rise
of return pressure, position as a lagging sensor sees it, and four bristles; where pressure sensors lag, what they see,
of each chamber a stage and the one that follows it. SI throughout. `p` is the record of
record.py, `records` an array of that one (which a call from the integrator hands over ten times as fast), `mode` the
automaton's: motion 0 rests and 1 slips; direction of slip -1 or 1; contact with a soft stop -1, 0, 1; held by an end
-1, 0, 1.
"""

from __future__ import annotations

import numpy as np
from numba import njit

POSITION, VELOCITY, PRESSURE_A, PRESSURE_B, SUPPLY_LOSS, RETURN_RISE, SENSED_POSITION, BRISTLE = range(8)
STATES = BRISTLE + 4
SENSED_PRESSURE = STATES
WITH_LATE_PRESSURES = STATES + 4
MOTION, DIRECTION, CONTACT, END = range(4)

REVERSAL_SPEED = 1e-9
END_GAP = 1e-12
"""m/s and m. A slip ends once it has reversed by that speed and an end is hit once passed by that much: far below what
matters, and a root that is not already there when the piston sets off.
"""

ELASTIC_PRESSURE = 1e6
"""Pa at which the friction of an elastic seal, which grows with the power 2/3 of its load, equals the proportional one
(assumed)."""

BOILING = 1e3
"""Pa of absolute pressure over which its fall ends: a tenth of a good sensor's noise, and smooth for the integrator
(assumed)."""

MAXWELL_WEIGHTS = (0.4, 0.3, 0.2, 0.1)
"""Shares of the total strength of the parallel elasto-slide elements; each has the same stiffness (assumed)."""


@njit(cache=True)
def root(drop, transition):  # type: ignore[no-untyped-def]
    """sign(d) sqrt|d| of a pressure drop [Pa], rounded off below the transition to laminar flow."""
    return drop / (drop * drop + transition * transition) ** 0.25


@njit(cache=True)
def land_opening(overlap, rounding):  # type: ignore[no-untyped-def]
    """Opening of one land [A]: zero while covered; a worn or chamfered edge rounds the corner to a hyperbola."""
    return 0.5 * (overlap + np.sqrt(overlap * overlap + rounding * rounding))


@njit(cache=True)
def saturated(opening, curvature, law):  # type: ignore[no-untyped-def]
    """What is left of an opening [A]: a hyperbola, or an orifice in series with one of opening 1 / curvature."""
    if law == 0.0:
        return 1.0 / (1.0 / max(opening, 1e-30) + curvature)
    return opening / np.sqrt(1.0 + (curvature * opening) ** 2)


@njit(cache=True)
def valve_flows(spool, pressure_a, pressure_b, supply, back, p):  # type: ignore[no-untyped-def]
    """Flow into A, out of B, out of the supply and into the return line [m^3/s]; four lands as a bridge of orifices."""
    x = spool + p.valve_null_offset_offset
    rounding = np.sqrt(p.valve_deadband_rounding**2 + p.valve_null_leakage_underlap**2)
    up = land_opening(x - p.valve_deadband_half_width, rounding)
    down = land_opening(-x - p.valve_deadband_half_width, rounding) * (1.0 - p.flow_gain_asymmetry_ratio)
    if p.flow_saturation_curvature > 0.0:
        up = saturated(up, p.flow_saturation_curvature, p.flow_saturation_law)
        down = saturated(down, p.flow_saturation_curvature, p.flow_saturation_law)
    gain, transition = p.valve_gain, p.transition_pressure
    supply_a = gain * up * root(supply - pressure_a, transition)
    a_return = gain * down * root(pressure_a - back, transition)
    supply_b = gain * down * root(supply - pressure_b, transition)
    b_return = gain * up * root(pressure_b - back, transition)
    if p.valve_null_leakage_conductance > 0.0:
        seep = p.valve_null_leakage_conductance * np.exp(-abs(spool) / p.valve_null_leakage_width)
        supply_a += seep * (supply - pressure_a)
        a_return += seep * (pressure_a - back)
        supply_b += seep * (supply - pressure_b)
        b_return += seep * (pressure_b - back)
    return supply_a - a_return, b_return - supply_b, supply_a + supply_b, a_return + b_return


@njit(cache=True)
def pump_line_rate(line, back, drawn, spool, p):  # type: ignore[no-untyped-def]
    """Rate of the pressure [Pa/s] in the line between pump and valve, at a flow `drawn` into the valve [m^3/s]."""
    middle = max(0.0, 1.0 - abs(spool) / p.pump_bypass_spool)
    lost = p.pump_leakage * (line - back) + p.pump_relief_gain * max(0.0, line - p.supply_pressure)
    lost += p.pump_bypass_gain * middle * root(line - back, p.transition_pressure)
    return p.bulk_modulus / p.pump_line_volume * (p.pump_displacement * abs(p.pump_speed) - lost - drawn)


@njit(cache=True)
def stiffness_of_oil(gauge, p):  # type: ignore[no-untyped-def]
    """Bulk modulus [Pa] of oil with entrained air at a gauge pressure [Pa], the gas polytropic with exponent 1.4.

    Law 0 differentiates the mixture's volume (Cho); law 1 is Nykanen's two-phase form.
    """
    fraction = p.entrained_air_air_fraction
    if fraction <= 0.0:
        return p.bulk_modulus
    reference = p.atmospheric_pressure
    absolute = max(gauge + reference, 100.0)
    exponent = 1.0 / 1.4
    gas = fraction * (reference / absolute) ** exponent
    if p.entrained_air_law == 0.0:
        liquid = (1.0 - fraction) * np.exp(-(absolute - reference) / p.bulk_modulus)
        return (liquid + gas) / (liquid / p.bulk_modulus + gas * exponent / absolute)
    return (1.0 - fraction + gas) ** 2 / ((1.0 - fraction) / p.bulk_modulus + gas * exponent / absolute)


@njit(cache=True)
def down_to_vacuum(rate, gauge, p):  # type: ignore[no-untyped-def]
    """The rate [Pa/s] of a chamber's gauge pressure [Pa]: at absolute zero the oil boils, and it falls no further."""
    absolute = gauge + p.atmospheric_pressure
    return rate if rate >= 0.0 else rate * (1.0 - np.exp(-max(absolute, 0.0) / BOILING))


@njit(cache=True)
def worn_share(position, p):  # type: ignore[no-untyped-def]
    """Share of the worn bore's highest conductance at a position [m].

    Law 0 is the slope of a hyperbolic tangent, law 1 a Gaussian. Law 2 is laminar flow through a clearance, with its
    cube: a Gaussian groove that doubles the clearance where it is deepest.
    """
    s = (position - p.bore_wear_leakage_centre) / p.bore_wear_leakage_width
    if p.bore_wear_leakage_law == 0.0:
        return 1.0 - np.tanh(s) ** 2
    groove = np.exp(-s * s)
    return groove if p.bore_wear_leakage_law == 1.0 else ((1.0 + groove) ** 3 - 1.0) / 7.0


@njit(cache=True)
def leakage_flow(difference, position, elapsed, p):  # type: ignore[no-untyped-def]
    """Flow from A to B past the piston [m^3/s]."""
    warmth = 1.0 - np.exp(-elapsed / p.thermal_drift_time_constant)
    conductance = p.internal_leakage * (1.0 + p.thermal_drift_leakage_ratio * warmth)
    if p.bore_wear_leakage_coefficient > 0.0:
        conductance += p.bore_wear_leakage_coefficient * worn_share(position, p)
    orifice = root(difference, p.turbulent_leakage_transition_pressure)
    flow = conductance * difference + p.turbulent_leakage_coefficient * orifice
    lifted = max(p.relief_leakage_direction * difference - p.relief_leakage_opening, 0.0)
    return flow + p.relief_leakage_direction * p.relief_leakage_coefficient * lifted


@njit(cache=True)
def stribeck_shape(speed, scale, law, exponent):  # type: ignore[no-untyped-def]
    """Share of the static excess left at a speed: with an exponent (2: Gaussian), Tustin's, or Hess and Soom's."""
    s = speed / scale
    if law == 0.0:
        return np.exp(-(s**exponent))
    if law == 1.0:
        return np.exp(-s)
    return 1.0 / (1.0 + s * s)


@njit(cache=True)
def dry_friction(speed, direction, across, p):  # type: ignore[no-untyped-def]
    """Magnitude of the set-valued friction [N] at a speed >= 0 in a direction; at speed 0 the force of break-away.

    `across`: the pressure difference [Pa] that presses the piston's seals.
    """
    height = p.coulomb_friction_force
    if p.load_friction_coefficient > 0.0:
        pressed = abs(across)
        if p.load_friction_law == 1.0:
            pressed = ELASTIC_PRESSURE ** (1.0 / 3.0) * pressed ** (2.0 / 3.0)
        height += p.load_friction_coefficient * pressed
    height += p.direction_friction_forward if direction > 0.0 else p.direction_friction_backward
    excess = p.stribeck_friction_static_force - p.stribeck_friction_force
    shape = stribeck_shape(
        speed, p.stribeck_friction_stribeck_velocity, p.stribeck_friction_law, p.stribeck_friction_shape
    )
    return height + p.stribeck_friction_force + excess * shape


@njit(cache=True)
def bristle_force(y, velocity, rates, p):  # type: ignore[no-untyped-def]
    """Friction [N] of presliding bristles; fills the bristles' rates [m/s]."""
    stiffness = p.presliding_friction_stiffness
    if stiffness <= 0.0:
        return 0.0
    law = p.presliding_friction_law
    kinetic = p.presliding_friction_force
    excess = p.presliding_friction_static_force - kinetic
    shape = stribeck_shape(abs(velocity), p.presliding_friction_stribeck_velocity, 1.0 if law == 1.0 else 0.0, 2.0)
    level = kinetic + excess * shape
    if law == 3.0:
        # Bouc and Wen's with n = 2: the bend turns over more sharply than a bristle's
        z = y[BRISTLE]
        rates[BRISTLE] = velocity - abs(velocity) * z * abs(z) * (stiffness / level) ** 2
        return stiffness * z + p.presliding_friction_damping * velocity
    if law != 2.0:
        z = y[BRISTLE]
        rates[BRISTLE] = velocity - stiffness * abs(velocity) / level * z
        return stiffness * z + p.presliding_friction_damping * rates[BRISTLE]
    force = 0.0
    element = stiffness / len(MAXWELL_WEIGHTS)
    for i in range(len(MAXWELL_WEIGHTS)):
        limit = MAXWELL_WEIGHTS[i] * kinetic / element
        z = y[BRISTLE + i]
        if not (abs(z) >= limit and z * velocity > 0.0):
            rates[BRISTLE + i] = velocity
        force += element * min(max(z, -limit), limit)
    return force * level / kinetic + p.presliding_friction_damping * velocity


@njit(cache=True)
def stop_force(position, velocity, contact, p):  # type: ignore[no-untyped-def]
    """Push of a soft end stop on the piston [N], towards the middle; a stop never pulls."""
    if contact == 0.0:
        return 0.0
    depth = position - p.end_stop_upper if contact > 0.0 else p.end_stop_lower - position
    closing = velocity * contact
    if p.end_stop_law == 0.0:
        push = p.end_stop_stiffness * depth + p.end_stop_damping * closing
    else:
        push = p.end_stop_stiffness * max(depth, 0.0) ** 1.5 * (1.0 + p.end_stop_damping * closing)
    return -contact * max(push, 0.0)


@njit(cache=True)
def smooth_force(y, elapsed, rates, mode, p):  # type: ignore[no-untyped-def]
    """Force on the piston [N] without the set-valued friction; fills the bristles' rates."""
    x, v = y[POSITION], y[VELOCITY]
    warmth = 1.0 - np.exp(-elapsed / p.thermal_drift_time_constant)
    damping = p.damping_coefficient * (1.0 - p.thermal_drift_damping_ratio * warmth)
    damping += np.sign(v) * p.directional_damping_ratio * damping
    damping += p.position_damping_coefficient * x * x + p.quadratic_damping_coefficient * abs(v)
    force = p.piston_area * y[PRESSURE_A] - p.piston_area_b * y[PRESSURE_B]
    force -= damping * v + p.spring_stiffness * x + p.hardening_spring_coefficient * x * x * x
    force -= p.constant_load_force + bristle_force(y, v, rates, p)
    force -= p.one_sided_spring_stiffness * max(x - p.one_sided_spring_start, 0.0)
    force += p.periodic_force_force * np.sin(2.0 * np.pi * p.periodic_force_frequency * elapsed)
    force += p.position_ripple_force * np.sin(2.0 * np.pi * x / p.position_ripple_pitch + p.position_ripple_phase)
    return force + stop_force(x, v, mode[CONTACT], p)


@njit(cache=True)
def trail(y, rates, place, pressure, time_constant, law):  # type: ignore[no-untyped-def]
    """Rates [Pa/s] of a lagging pressure sensor's two stages: one of first order, or two alike with the same delay."""
    if time_constant > 0.0:
        stage = time_constant if law == 0.0 else 0.5 * time_constant
        rates[place] = (pressure - y[place]) / stage
        rates[place + 1] = (y[place] - y[place + 1]) / stage


@njit(cache=True)
def derivatives(time, y, rates, spool, mode, records):  # type: ignore[no-untyped-def]
    """Fill the rates of all states at a time [s] and spool position [A]."""
    p = records[0]
    rates[:] = 0.0
    x, v = y[POSITION], y[VELOCITY]
    a, b = y[PRESSURE_A], y[PRESSURE_B]
    supply = p.supply_pressure - y[SUPPLY_LOSS]
    back = p.return_pressure + y[RETURN_RISE]
    into_a, out_of_b, drawn, returned = valve_flows(spool, a, b, supply, back, p)
    rates[SUPPLY_LOSS] = (p.supply_pressure_droop_resistance * drawn - y[SUPPLY_LOSS]) / (
        p.supply_pressure_droop_time_constant
    )
    if p.pump_displacement > 0.0:
        rates[SUPPLY_LOSS] = -pump_line_rate(supply, back, drawn, spool, p)
    rates[RETURN_RISE] = (p.return_back_pressure_resistance * returned - y[RETURN_RISE]) / (
        p.return_back_pressure_time_constant
    )
    past = leakage_flow(a - b, x, time, p)
    lost_a = (p.external_leakage + p.external_leakage_coefficient_a) * a
    lost_b = (p.external_leakage + p.external_leakage_coefficient_b) * b
    volume_a = p.line_volume + p.piston_area * (p.actuator_displacement + x)
    volume_b = p.line_volume + p.piston_area_b * (p.actuator_displacement - x)
    net_a, net_b = into_a - past - lost_a - p.piston_area * v, p.piston_area_b * v - out_of_b + past - lost_b
    rates[PRESSURE_A] = down_to_vacuum(stiffness_of_oil(a, p) / volume_a * net_a, a, p)
    rates[PRESSURE_B] = down_to_vacuum(stiffness_of_oil(b, p) / volume_b * net_b, b, p)
    if p.position_sensor_lag_time_constant > 0.0:
        rates[SENSED_POSITION] = (x - y[SENSED_POSITION]) / p.position_sensor_lag_time_constant
    if len(y) == WITH_LATE_PRESSURES:
        law = p.pressure_sensor_lag_law
        trail(y, rates, SENSED_PRESSURE, a, p.pressure_sensor_lag_time_constant_a, law)
        trail(y, rates, SENSED_PRESSURE + 2, b, p.pressure_sensor_lag_time_constant_b, law)
    if mode[MOTION] == 0.0:
        return
    force = smooth_force(y, time, rates, mode, p)
    rates[POSITION] = v
    rates[VELOCITY] = (force - mode[DIRECTION] * dry_friction(abs(v), mode[DIRECTION], a - b, p)) / p.moving_mass


@njit(cache=True)
def margins(time, y, mode, records):  # type: ignore[no-untyped-def]
    """Net force at rest and the forces of break-away forward and backward [N]; infinite where a cylinder end holds."""
    p = records[0]
    force = smooth_force(y, time, np.zeros(STATES), mode, p)
    across = y[PRESSURE_A] - y[PRESSURE_B]
    forward = np.inf if mode[END] > 0.0 else dry_friction(0.0, 1.0, across, p)
    backward = np.inf if mode[END] < 0.0 else dry_friction(0.0, -1.0, across, p)
    return force, forward, backward


@njit(cache=True)
def events(time, y, values, mode, records):  # type: ignore[no-untyped-def]
    """Fill the five event functions; one that the mode does not have stays at 1.

    End of slip or forward break-away, upper end or backward break-away, lower end, upper soft stop, lower soft stop.
    """
    p = records[0]
    values[:] = 1.0
    x = y[POSITION]
    values[3] = x - p.end_stop_upper
    values[4] = x - p.end_stop_lower
    if mode[MOTION] == 0.0:
        force, forward, backward = margins(time, y, mode, records)
        values[0] = 1.0 if np.isinf(forward) else forward - force
        values[1] = 1.0 if np.isinf(backward) else force + backward
        return
    if dry_friction(0.0, mode[DIRECTION], 1.0, p) > 0.0:
        values[0] = mode[DIRECTION] * y[VELOCITY] + REVERSAL_SPEED
    values[1] = p.actuator_displacement - x + END_GAP
    values[2] = x + p.actuator_displacement + END_GAP
