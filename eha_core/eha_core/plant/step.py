"""The compiled step of the actuator, equations (1) to (10), with a place for each site's effects.

One step is a Strang splitting. Coil and spool do not depend on the piston and go first, by exact propagators. Then half
a step of oil and position, a whole step of velocity, half a step of oil and position:

* oil: exponential Rosenbrock-Euler with the L-stable rational approximation of its function, so that ports held open at
  small pressure differences and strong leakage stay stable at any step;
* velocity: damping implicit, dry friction as a proximal step (it sticks exactly and is not stiff), and the mass
  enlarged by `theta h^2 k`, where k is the stiffness of oil, spring and stops. With theta = 1/12 the staggered scheme's
  frequency error falls from second to fourth order in h; theta rises to 1/4 for k h^2 / M large, where the scheme is
  then stable for any k;
* the stroke's ends: a piston that would pass one lands on it with what speed the rest of the step needs, and stops
  (an inelastic impact). Absolute pressures end at zero, where the oil would boil.

This file is compiled as it stands for the nominal plant, and once more beside generated `hooks` for the whole
catalogue.
"""

from __future__ import annotations

from math import sqrt

from eha_core.compiled import compiled, inlined, unowned

from .hooks import chamber, command, force, orifice, schedule, sensor, spool, supply

(
    COIL_RESISTANCE,
    COIL_INDUCTANCE,
    SATURATION_CURRENT,
    VALVE_DAMPING_RATIO,
    VALVE_NATURAL_FREQUENCY,
    VALVE_GAIN,
    BULK_MODULUS,
    SUPPLY_PRESSURE,
    RETURN_PRESSURE,
    SPRING_STIFFNESS,
    ACTUATOR_DISPLACEMENT,
    PISTON_AREA,
    PISTON_AREA_B,
    MOVING_MASS,
    DAMPING_COEFFICIENT,
    INTERNAL_LEAKAGE,
    EXTERNAL_LEAKAGE,
    LINE_VOLUME,
    ATMOSPHERIC_PRESSURE,
) = range(19)
"""Where each nominal parameter stands in the vector that compiled functions see: the order of `parameters.NOMINAL`."""

TRANSITION_PRESSURE = 1e4
"""Pa; below about this pressure difference an orifice's flow turns laminar (assumed). It bounds the root's slope."""

TRANSITION_SLOPE = TRANSITION_PRESSURE**-0.5


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
def port_flows(spool_position, pressure_a, pressure_b, supply_pressure, return_pressure, parameters, active):
    """Flow into port A and out of port B, equation (3), and how fast its own chamber's pressure throttles each."""
    gain = parameters[VALVE_GAIN]
    opening, gain, conductance = orifice(spool_position, gain, 0.0, spool_position, parameters, active)
    if opening >= 0.0:
        root_a, slope_a = orifice_root(supply_pressure - pressure_a)
        root_b, slope_b = orifice_root(pressure_b - return_pressure)
    else:
        root_a, slope_a = orifice_root(pressure_a - return_pressure)
        root_b, slope_b = orifice_root(supply_pressure - pressure_b)
    flow = gain * opening
    flow_a, flow_b = flow * root_a, flow * root_b
    fall_a, rise_b = abs(flow) * slope_a, abs(flow) * slope_b
    if conductance > 0.0:
        flow_a += conductance * (supply_pressure + return_pressure - 2.0 * pressure_a)
        flow_b -= conductance * (supply_pressure + return_pressure - 2.0 * pressure_b)
        fall_a += 2.0 * conductance
        rise_b += 2.0 * conductance
    return flow_a, flow_b, fall_a, rise_b


@inlined
def oil_half_step(
    tau, spool_position, position, velocity, pressure_a, pressure_b, supply_pressure, return_pressure,
    internal_leakage, parameters, active,
):
    """Equations (4) to (9) over the time tau with the piston moving steadily through `position`.

    Returns both pressures, both flows, area B in force, and the oil's stiffness as the piston feels it.
    """
    area_a, line = parameters[PISTON_AREA], parameters[LINE_VOLUME]
    difference = pressure_a - pressure_b
    area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross, cross_slope, leak_a, leak_b = chamber(
        parameters[PISTON_AREA_B], parameters[BULK_MODULUS], 0.0, parameters[BULK_MODULUS], 0.0,
        internal_leakage * difference, internal_leakage, parameters[EXTERNAL_LEAKAGE], parameters[EXTERNAL_LEAKAGE],
        pressure_a, pressure_b, parameters[ATMOSPHERIC_PRESSURE], parameters, active,
    )
    flow_a, flow_b, fall_a, rise_b = port_flows(
        spool_position, pressure_a, pressure_b, supply_pressure, return_pressure, parameters, active
    )
    volume_a = line + area_a * (parameters[ACTUATOR_DISPLACEMENT] + position)
    volume_b = line + area_b * (parameters[ACTUATOR_DISPLACEMENT] - position)
    inverse = 1.0 / (volume_a * volume_b)
    spring_a = bulk_a * volume_b * inverse
    spring_b = bulk_b * volume_a * inverse
    net_a = flow_a - cross - leak_a * pressure_a - area_a * velocity
    net_b = area_b * velocity - flow_b + cross - leak_b * pressure_b
    # z = tau J; the step is (1 - z + z^2/2)^-1 (1 - z/2) tau f, exponential Rosenbrock-Euler to its second order.
    # In z's trace and determinant (Cayley, Hamilton) it has no differences of large numbers, however strong the leakage
    z_ab = tau * spring_a * cross_slope
    z_ba = tau * spring_b * cross_slope
    own_a = tau * spring_a * (bulk_change_a * net_a - fall_a - leak_a)
    own_b = tau * spring_b * (bulk_change_b * net_b - rise_b - leak_b)
    f_a = tau * spring_a * net_a
    f_b = tau * spring_b * net_b
    trace = own_a + own_b - z_ab - z_ba
    determinant = own_a * own_b - own_a * z_ba - own_b * z_ab
    shared = 1.0 - trace + 0.5 * trace * trace - 0.25 * determinant * trace
    scale = 1.0 / (shared - 0.25 * determinant * (trace - determinant))
    once = (0.5 - 0.5 * trace + 0.25 * determinant) * scale
    change_a = shared * scale * f_a + once * (own_a * f_a + z_ab * (f_b - f_a))
    change_b = shared * scale * f_b + once * (own_b * f_b + z_ba * (f_a - f_b))
    floor = -parameters[ATMOSPHERIC_PRESSURE]
    pressure_a = max(floor, pressure_a + change_a)
    pressure_b = max(floor, pressure_b + change_b)
    stiffness = area_a * area_a * spring_a + area_b * area_b * spring_b
    return pressure_a, pressure_b, flow_a, flow_b, area_b, stiffness


@inlined
def effective_velocity(tau, position, velocity, stroke):
    """The speed that, over the time tau, lands a piston on the stroke's end where `velocity` would carry it past."""
    reached = position + tau * velocity
    if reached > stroke:
        return (stroke - position) / tau
    if reached < -stroke:
        return (-stroke - position) / tau
    return velocity


@inlined
def piston_step(
    step_size, position, velocity, pressure_a, pressure_b, area_b, oil_stiffness, damping, memory, parameters, active,
):
    """Equation (10) over one step at a held position. Returns the velocity, the hydraulic force and F_f of (10)."""
    mass, spring, stroke = parameters[MOVING_MASS], parameters[SPRING_STIFFNESS], parameters[ACTUATOR_DISPLACEMENT]
    other, total_damping, stop_stiffness, dry = force(
        0.0, damping, 0.0, 0.0, position, velocity, pressure_a, pressure_b, memory, step_size, parameters, active
    )
    hydraulic = parameters[PISTON_AREA] * pressure_a - area_b * pressure_b
    driving = hydraulic - spring * position
    stiff = step_size * step_size * (oil_stiffness + spring + stop_stiffness)
    # mass in the step = mass + theta stiff = bulky / thin, theta = (mass + stiff) / (4 (3 mass + stiff)): one division
    thin = 3.0 * mass + stiff
    bulky = mass * thin + 0.25 * stiff * (mass + stiff)
    drag = step_size * thin * total_damping
    inverse = 1.0 / (bulky * bulky + drag * (bulky + 0.5 * drag))
    shrink = bulky * bulky * inverse
    impulse = step_size * thin * (bulky + 0.5 * drag) * inverse
    new = shrink * velocity + impulse * (driving + other)
    if dry > 0.0:
        new = max(0.0, new - impulse * dry) if new > 0.0 else min(0.0, new + impulse * dry)
    new = effective_velocity(0.5 * step_size, position, new, stroke)
    friction = driving - damping * 0.5 * (velocity + new) - bulky / (step_size * thin) * (new - velocity)
    return new, hydraulic, friction


@inlined
def valve_step(voltage, target, spool_position, spool_velocity, current, propagator, memory, parameters, active):
    """Equations (1) and (2) over one step under a held voltage: exact but for the current's saturation."""
    current = propagator[0] * current + (1.0 - propagator[0]) * propagator[1] * voltage
    saturation = parameters[SATURATION_CURRENT]
    current = min(saturation, max(-saturation, current))
    new_target = spool(current, memory, parameters, active)
    position = (
        propagator[2] * spool_position + propagator[3] * spool_velocity
        + propagator[4] * target + propagator[5] * new_target
    )
    velocity = (
        propagator[6] * spool_position + propagator[7] * spool_velocity
        + propagator[8] * target + propagator[9] * new_target
    )
    return current, new_target, position, velocity


@inlined
def write_row(row, voltage, state, hydraulic, friction, leakage, seen, parameters, active):
    """Fill one row of COLUMNS from the state at the end of a step."""
    supply_pressure, return_pressure = state[2], state[3]
    spool_position, pressure_a, pressure_b = state[5], state[9], state[10]
    flow_a, flow_b, _, _ = port_flows(
        spool_position, pressure_a, pressure_b, supply_pressure, return_pressure, parameters, active
    )
    bulk, outside = parameters[BULK_MODULUS], parameters[EXTERNAL_LEAKAGE]
    _, _, _, _, _, cross, _, leak_a, leak_b = chamber(
        parameters[PISTON_AREA_B], bulk, 0.0, bulk, 0.0, leakage * (pressure_a - pressure_b), leakage, outside, outside,
        pressure_a, pressure_b, parameters[ATMOSPHERIC_PRESSURE], parameters, active,
    )
    row[0] = voltage
    row[1:8] = state[4:11]
    row[8], row[9], row[10] = flow_a, flow_b, cross
    row[11], row[12] = leak_a * pressure_a, leak_b * pressure_b
    row[13], row[14] = supply_pressure, return_pressure
    row[15], row[16], row[17] = hydraulic, friction, leakage
    row[18], row[19], row[20], row[21] = seen


@compiled
def advance(state, memory, history, parameters, active, propagator, voltages, step_size, every, rows):
    """Advance `state` by one step for each of `voltages`, and write a row after every `every` of them.

    Rows as wide as COLUMNS take them all; rows of four take what the sensors say.

    state: time, last target, supply and return pressure in force, then the columns current to pressure_b.
    history: ring of past voltages; its last element holds the index of the latest.
    propagator: coil decay, 1 / R_c, then for spool position and rate each: from position, from rate, from the old
    target, from the new target.
    """
    time, target, supply_pressure, return_pressure = state[0], state[1], state[2], state[3]
    current, spool_position, spool_velocity = state[4], state[5], state[6]
    position, velocity, pressure_a, pressure_b = state[7], state[8], state[9], state[10]
    memory, history = unowned(memory), unowned(history)
    newest, ring = int(history[-1]), history.shape[0] - 1
    stroke, tau = parameters[ACTUATOR_DISPLACEMENT], 0.5 * step_size
    for index in range(voltages.shape[0]):
        newest = newest + 1 if newest + 1 < ring else 0
        history[newest] = voltages[index]
        voltage = command(voltages[index], history, newest, step_size, parameters, active)
        leakage, damping = schedule(
            parameters[INTERNAL_LEAKAGE], parameters[DAMPING_COEFFICIENT], time + tau, parameters, active
        )
        before = spool_position
        current, target, spool_position, spool_velocity = valve_step(
            voltage, target, spool_position, spool_velocity, current, propagator, memory, parameters, active
        )
        moving = effective_velocity(tau, position, velocity, stroke)
        pressure_a, pressure_b, _, _, area_b, stiffness = oil_half_step(
            tau, 0.75 * before + 0.25 * spool_position, position + 0.5 * tau * moving, moving, pressure_a, pressure_b,
            supply_pressure, return_pressure, leakage, parameters, active,
        )
        position += tau * moving
        velocity, hydraulic, friction = piston_step(
            step_size, position, velocity, pressure_a, pressure_b, area_b, stiffness, damping,
            memory, parameters, active,
        )
        pressure_a, pressure_b, flow_a, flow_b, _, _ = oil_half_step(
            tau, 0.25 * before + 0.75 * spool_position, position + 0.5 * tau * velocity, velocity,
            pressure_a, pressure_b, supply_pressure, return_pressure, leakage, parameters, active,
        )
        position += tau * velocity
        if position >= stroke:
            position, velocity = stroke, min(velocity, 0.0)
        elif position <= -stroke:
            position, velocity = -stroke, max(velocity, 0.0)
        supply_flow, return_flow = (flow_a, flow_b) if spool_position >= 0.0 else (-flow_b, -flow_a)
        supply_pressure, return_pressure = supply(
            parameters[SUPPLY_PRESSURE], parameters[RETURN_PRESSURE], supply_flow, return_flow,
            memory, step_size, parameters, active,
        )
        time += step_size
        seen = sensor(position, velocity, pressure_a, pressure_b, memory, step_size, parameters, active)
        if (index + 1) % every == 0:
            state[0], state[1], state[2], state[3] = time, target, supply_pressure, return_pressure
            state[4], state[5], state[6] = current, spool_position, spool_velocity
            state[7], state[8], state[9], state[10] = position, velocity, pressure_a, pressure_b
            row = rows[(index + 1) // every - 1]
            if row.shape[0] == 4:
                row[0], row[1], row[2], row[3] = seen
            else:
                write_row(row, voltages[index], state, hydraulic, friction, leakage, seen, parameters, active)
    history[-1] = newest
    state[0], state[1], state[2], state[3] = time, target, supply_pressure, return_pressure
    state[4], state[5], state[6] = current, spool_position, spool_velocity
    state[7], state[8], state[9], state[10] = position, velocity, pressure_a, pressure_b


@compiled
def advance_driven(state, memory, parameters, active, pressures_a, pressures_b, step_size, every, rows):
    """Advance position and velocity alone, driven by given chamber pressures held over each step: equation (10).

    `state` is as in `advance`, of which this moves time, position and velocity; rows are those of the sensors.
    """
    memory = unowned(memory)
    time, position, velocity = state[0], state[7], state[8]
    stroke, tau = parameters[ACTUATOR_DISPLACEMENT], 0.5 * step_size
    pressure_a, pressure_b = state[9], state[10]
    for index in range(pressures_a.shape[0]):
        pressure_a, pressure_b = pressures_a[index], pressures_b[index]
        _, damping = schedule(
            parameters[INTERNAL_LEAKAGE], parameters[DAMPING_COEFFICIENT], time + tau, parameters, active
        )
        position += tau * effective_velocity(tau, position, velocity, stroke)
        area_b, _, _, _, _, _, _, _, _ = chamber(
            parameters[PISTON_AREA_B], 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, pressure_a, pressure_b,
            parameters[ATMOSPHERIC_PRESSURE], parameters, active,
        )
        velocity, _, _ = piston_step(
            step_size, position, velocity, pressure_a, pressure_b, area_b, 0.0, damping, memory, parameters, active
        )
        position += tau * velocity
        if position >= stroke:
            position, velocity = stroke, min(velocity, 0.0)
        elif position <= -stroke:
            position, velocity = -stroke, max(velocity, 0.0)
        time += step_size
        seen = sensor(position, velocity, pressure_a, pressure_b, memory, step_size, parameters, active)
        if (index + 1) % every == 0:
            row = rows[(index + 1) // every - 1]
            row[0], row[1], row[2], row[3] = seen
    state[0], state[7], state[8], state[9], state[10] = time, position, velocity, pressure_a, pressure_b
