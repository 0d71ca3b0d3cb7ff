"""The compiled step of the actuator, equations (1) to (10), with a place for each site's effects.

`scheme` holds the pieces of a step; here the hooks stand between them. This file is compiled unchanged for the
nominal plant, and once more beside generated `hooks` for the whole catalogue; for sources other than the servo valve,
also beside a `source` of the same functions. `lanes` takes the same step for many parameter sets at once.
"""

from __future__ import annotations

from eha_core.compiled import compiled, inlined, unowned
from eha_core.plant.equations import (
    driving_force,
    external_leakage_flow,
    hydraulic_force,
    internal_leakage_flow,
    volumes,
)
from eha_core.plant.scheme import (
    effective_velocity,
    friction_force,
    held_at_the_ends,
    implicit_mass,
    oil_step,
    velocity_step,
)
from eha_core.plant.state import AT, COLUMN
from eha_core.plant.vector import (
    ACTUATOR_DISPLACEMENT,
    ATMOSPHERIC_PRESSURE,
    BULK_MODULUS,
    DAMPING_COEFFICIENT,
    EXTERNAL_LEAKAGE,
    INTERNAL_LEAKAGE,
    LINE_VOLUME,
    MOVING_MASS,
    PISTON_AREA,
    PISTON_AREA_B,
    RETURN_PRESSURE,
    SPRING_STIFFNESS,
    SUPPLY_PRESSURE,
    VALVE_GAIN,
)

from .hooks import chamber, command, force, orifice, schedule, sensor, spool, supply
from .source import current_of, fed, given_at, ports, spool_of, supply_in_force, voltage_of


@inlined
def ports_of(given, spool_position, pressure_a, pressure_b, supply_pressure, return_pressure, parameters, active):
    """The ports' flows: see `scheme.port_flows`."""
    opening, gain, conductance = orifice(
        spool_position, parameters[VALVE_GAIN], 0.0, spool_position, parameters, active
    )
    return ports(
        given, opening, gain, conductance, pressure_a, pressure_b, supply_pressure, return_pressure, parameters
    )


@inlined
def chambers_of(bulk, internal_leakage, outside, position, pressure_a, pressure_b, parameters, active):
    """What the continuity equations of the chambers are made of: see `hooks.chamber`."""
    return chamber(
        parameters[PISTON_AREA_B], bulk, 0.0, bulk, 0.0,
        internal_leakage_flow(internal_leakage, pressure_a, pressure_b), internal_leakage, outside, outside,
        position, pressure_a, pressure_b, parameters[ATMOSPHERIC_PRESSURE], parameters, active,
    )  # fmt: skip


@inlined
def oil_half_step(
    tau, given, spool_position, position, velocity, pressure_a, pressure_b, supply_pressure, return_pressure,
    internal_leakage, parameters, active,
):  # fmt: skip
    """Equations (4) to (9) over the time tau with the piston moving steadily through `position`.

    Returns both pressures and the supply's, the flows out of the supply and into the return line, area B in force, and
    the oil's stiffness as the piston feels it.
    """
    chambers = chambers_of(
        parameters[BULK_MODULUS], internal_leakage, parameters[EXTERNAL_LEAKAGE], position, pressure_a, pressure_b,
        parameters, active,
    )  # fmt: skip
    flows = ports_of(
        given, spool_position, pressure_a, pressure_b, supply_pressure, return_pressure, parameters, active
    )
    flows, supply_pressure = fed(
        tau, given, flows, chambers, spool_position, position, velocity, pressure_a, pressure_b, supply_pressure,
        return_pressure, parameters,
    )  # fmt: skip
    pressure_a, pressure_b, stiffness = oil_step(
        tau, flows, chambers, position, velocity, pressure_a, pressure_b, parameters[PISTON_AREA],
        parameters[ACTUATOR_DISPLACEMENT], parameters[LINE_VOLUME], parameters[ATMOSPHERIC_PRESSURE],
    )  # fmt: skip
    return pressure_a, pressure_b, supply_pressure, flows[4], flows[5], chambers[0], stiffness


@inlined
def piston_step(
    step_size, position, velocity, pressure_a, pressure_b, area_b, oil_stiffness, damping, memory, parameters, active,
):  # fmt: skip
    """Equation (10) over one step at a held position. Returns the velocity, the hydraulic force and F_f of (10)."""
    resistance = force(
        0.0, damping, 0.0, 0.0, position, velocity, pressure_a, pressure_b, memory, step_size, parameters, active
    )
    hydraulic = hydraulic_force(parameters[PISTON_AREA], area_b, pressure_a, pressure_b)
    mass, spring = parameters[MOVING_MASS], parameters[SPRING_STIFFNESS]
    driving = driving_force(hydraulic, spring, position)
    new = velocity_step(
        step_size, position, velocity, driving, resistance, oil_stiffness, mass, spring,
        parameters[ACTUATOR_DISPLACEMENT],
    )  # fmt: skip
    friction = friction_force(step_size, velocity, new, driving, damping, resistance[2], oil_stiffness, mass, spring)
    return new, hydraulic, friction


@inlined
def valve_step(voltage, given, target, spool_position, spool_velocity, current, propagator, memory, parameters, active):
    """Equations (1) and (2) over one step under a held input: exact but for the current's saturation.

    Returns the current, what the spool follows, where the spool is as the step begins, and its state at the end.
    """
    current = current_of(voltage, given, current, propagator, parameters)
    new_target = spool(current, memory, parameters, active)
    before, position, velocity = spool_of(
        given, spool_position, spool_velocity, target, new_target, propagator, parameters
    )
    return current, new_target, before, position, velocity


@inlined
def write_seen(row, seen):
    """Fill four columns with what the sensors say."""
    row[0], row[1], row[2], row[3] = seen


@inlined
def write_row(row, given, state, hydraulic, friction, leakage, seen, parameters, active):
    """Fill one row of COLUMNS from the state at the end of a step."""
    supply_pressure, return_pressure = state[AT.supply_pressure], state[AT.return_pressure]
    spool_position, pressure_a, pressure_b = state[AT.spool_position], state[AT.pressure_a], state[AT.pressure_b]
    flow_a, flow_b, _, _, _, _ = ports_of(
        given, spool_position, pressure_a, pressure_b, supply_pressure, return_pressure, parameters, active
    )
    _, _, _, _, _, cross, _, leak_a, leak_b = chambers_of(
        parameters[BULK_MODULUS], leakage, parameters[EXTERNAL_LEAKAGE], state[AT.position], pressure_a, pressure_b,
        parameters, active,
    )  # fmt: skip
    row[COLUMN.voltage] = voltage_of(given)
    row[COLUMN.current : COLUMN.flow_a] = state[AT.current :]
    row[COLUMN.flow_a], row[COLUMN.flow_b], row[COLUMN.internal_leakage_flow] = flow_a, flow_b, cross
    row[COLUMN.external_leakage_flow_a] = external_leakage_flow(leak_a, pressure_a)
    row[COLUMN.external_leakage_flow_b] = external_leakage_flow(leak_b, pressure_b)
    row[COLUMN.supply_pressure], row[COLUMN.return_pressure] = supply_pressure, return_pressure
    row[COLUMN.hydraulic_force], row[COLUMN.friction_force] = hydraulic, friction
    row[COLUMN.internal_leakage] = leakage
    write_seen(row[COLUMN.measured_position :], seen)


@inlined
def write(row, given, state, hydraulic, friction, leakage, seen, parameters, active):
    """Fill a row as wide as COLUMNS with them all, one of four with what the sensors say."""
    if row.shape[0] == 4:
        write_seen(row, seen)
    else:
        write_row(row, given, state, hydraulic, friction, leakage, seen, parameters, active)


@inlined
def write_driven(row, position, velocity, pressure_a, pressure_b, hydraulic, friction, seen):
    """Fill those of COLUMNS that a plant driven by its pressures has; the others are zero."""
    row[:] = 0.0
    row[COLUMN.position], row[COLUMN.velocity] = position, velocity
    row[COLUMN.pressure_a], row[COLUMN.pressure_b] = pressure_a, pressure_b
    row[COLUMN.hydraulic_force], row[COLUMN.friction_force] = hydraulic, friction
    write_seen(row[COLUMN.measured_position :], seen)


@inlined
def kept(state):
    """Everything that `keep` puts in its place, in its order."""
    return (
        state[AT.time], state[AT.target], state[AT.supply_pressure], state[AT.return_pressure], state[AT.current],
        state[AT.spool_position], state[AT.spool_velocity], state[AT.position], state[AT.velocity],
        state[AT.pressure_a], state[AT.pressure_b],
    )  # fmt: skip


@inlined
def keep(
    state, time, target, supply_pressure, return_pressure, current, spool_position, spool_velocity, position, velocity,
    pressure_a, pressure_b,
):  # fmt: skip
    """Put everything that `Places` lists in its place."""
    state[AT.time], state[AT.target] = time, target
    state[AT.supply_pressure], state[AT.return_pressure] = supply_pressure, return_pressure
    state[AT.current], state[AT.spool_position], state[AT.spool_velocity] = current, spool_position, spool_velocity
    state[AT.position], state[AT.velocity] = position, velocity
    state[AT.pressure_a], state[AT.pressure_b] = pressure_a, pressure_b


@compiled
def advance(state, memory, history, parameters, active, propagator, inputs, step_size, every, rows):
    """Advance `state` by one step for each of `inputs`, and `write` a row after every `every` of them.

    state: see `eha_core.plant.state.Places`.
    inputs: (steps,) voltages; of other sources than the servo valve, (steps, 2) what `given` says.
    history: ring of past voltages; its last element holds the index of the latest.
    propagator: coil decay, 1 / R_c, then for spool position and rate each: from position, from rate, from the old
    target, from the new target.
    """
    (
        time, target, supply_pressure, return_pressure, current, spool_position, spool_velocity, position, velocity,
        pressure_a, pressure_b,
    ) = kept(state)  # fmt: skip
    memory, history = unowned(memory), unowned(history)
    newest, ring = int(history[-1]), history.shape[0] - 1
    stroke, tau = parameters[ACTUATOR_DISPLACEMENT], 0.5 * step_size
    for index in range(inputs.shape[0]):
        given = given_at(inputs, index)
        newest = newest + 1 if newest + 1 < ring else 0
        history[newest] = voltage_of(given)
        voltage = command(voltage_of(given), history, newest, step_size, parameters, active)
        leakage, damping = schedule(
            parameters[INTERNAL_LEAKAGE], parameters[DAMPING_COEFFICIENT], time + tau, parameters, active
        )
        current, target, before, spool_position, spool_velocity = valve_step(
            voltage, given, target, spool_position, spool_velocity, current, propagator, memory, parameters, active
        )
        moving = effective_velocity(tau, position, velocity, stroke)
        pressure_a, pressure_b, supply_pressure, _, _, area_b, stiffness = oil_half_step(
            tau, given, 0.75 * before + 0.25 * spool_position, position + 0.5 * tau * moving, moving,
            pressure_a, pressure_b, supply_pressure, return_pressure, leakage, parameters, active,
        )  # fmt: skip
        position += tau * moving
        velocity, hydraulic, friction = piston_step(
            step_size, position, velocity, pressure_a, pressure_b, area_b, stiffness, damping,
            memory, parameters, active,
        )  # fmt: skip
        pressure_a, pressure_b, supply_pressure, supply_flow, return_flow, _, _ = oil_half_step(
            tau, given, 0.25 * before + 0.75 * spool_position, position + 0.5 * tau * velocity, velocity,
            pressure_a, pressure_b, supply_pressure, return_pressure, leakage, parameters, active,
        )  # fmt: skip
        position, velocity = held_at_the_ends(position + tau * velocity, velocity, stroke)
        stated, return_pressure = supply(
            parameters[SUPPLY_PRESSURE], parameters[RETURN_PRESSURE], supply_flow, return_flow,
            memory, step_size, parameters, active,
        )  # fmt: skip
        supply_pressure = supply_in_force(supply_pressure, stated, parameters)
        time += step_size
        seen = sensor(position, velocity, pressure_a, pressure_b, memory, step_size, parameters, active)
        if (index + 1) % every == 0:
            keep(
                state, time, target, supply_pressure, return_pressure, current, spool_position, spool_velocity,
                position, velocity, pressure_a, pressure_b,
            )  # fmt: skip
            write(rows[(index + 1) // every - 1], given, state, hydraulic, friction, leakage, seen, parameters, active)
    history[-1] = newest
    keep(
        state, time, target, supply_pressure, return_pressure, current, spool_position, spool_velocity,
        position, velocity, pressure_a, pressure_b,
    )  # fmt: skip


@compiled
def advance_driven(state, memory, parameters, active, pressures_a, pressures_b, step_size, every, rows):
    """Advance position and velocity alone, driven by given chamber pressures held over each step: equation (10).

    `state` is as in `advance`, of which this moves time, position and velocity. Rows are as there; of those as wide as
    COLUMNS it fills what such a plant has.
    """
    memory = unowned(memory)
    time, position, velocity = state[AT.time], state[AT.position], state[AT.velocity]
    stroke, tau = parameters[ACTUATOR_DISPLACEMENT], 0.5 * step_size
    pressure_a, pressure_b = state[AT.pressure_a], state[AT.pressure_b]
    for index in range(pressures_a.shape[0]):
        pressure_a, pressure_b = pressures_a[index], pressures_b[index]
        _, damping = schedule(
            parameters[INTERNAL_LEAKAGE], parameters[DAMPING_COEFFICIENT], time + tau, parameters, active
        )
        position += tau * effective_velocity(tau, position, velocity, stroke)
        area_b = chambers_of(1.0, 0.0, 0.0, position, pressure_a, pressure_b, parameters, active)[0]
        velocity, hydraulic, friction = piston_step(
            step_size, position, velocity, pressure_a, pressure_b, area_b, 0.0, damping, memory, parameters, active
        )
        position, velocity = held_at_the_ends(position + tau * velocity, velocity, stroke)
        time += step_size
        seen = sensor(position, velocity, pressure_a, pressure_b, memory, step_size, parameters, active)
        if (index + 1) % every == 0:
            row = rows[(index + 1) // every - 1]
            if row.shape[0] == 4:
                write_seen(row, seen)
            else:
                write_driven(row, position, velocity, pressure_a, pressure_b, hydraulic, friction, seen)
    state[AT.time], state[AT.position], state[AT.velocity] = time, position, velocity
    state[AT.pressure_a], state[AT.pressure_b] = pressure_a, pressure_b


@compiled
def reaction(state, memory, parameters, active, mass, step_size):
    """What the actuator does over one step, its pressures held, to a load of `mass` that another simulation moves.

    Returns the force at the velocity at the step's start, the dry friction that opposes motion in addition, and what
    the mass is to be enlarged by.
    """
    memory = unowned(memory)
    position, velocity = state[AT.position], state[AT.velocity]
    pressure_a, pressure_b = state[AT.pressure_a], state[AT.pressure_b]
    area_a, spring = parameters[PISTON_AREA], parameters[SPRING_STIFFNESS]
    _, damping = schedule(0.0, parameters[DAMPING_COEFFICIENT], state[AT.time], parameters, active)
    area_b, bulk_a, _, bulk_b, _, _, _, _, _ = chambers_of(
        parameters[BULK_MODULUS], 0.0, 0.0, position, pressure_a, pressure_b, parameters, active
    )
    volume_a, volume_b = volumes(position, area_a, area_b, parameters[ACTUATOR_DISPLACEMENT], parameters[LINE_VOLUME])
    other, damping, stop_stiffness, dry = force(
        0.0, damping, 0.0, 0.0, position, velocity, pressure_a, pressure_b, memory, step_size, parameters, active
    )
    stiffness = area_a * area_a * bulk_a / volume_a + area_b * area_b * bulk_b / volume_b + spring + stop_stiffness
    driving = driving_force(hydraulic_force(area_a, area_b, pressure_a, pressure_b), spring, position)
    enlarged = implicit_mass(mass, step_size * step_size * stiffness, step_size * damping)
    return driving + other - damping * velocity, dry, enlarged - mass
