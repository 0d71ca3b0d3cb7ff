"""The step of `step.py` for several parameter sets at once: loops over lanes that the compiler vectorises.

The pieces are those of `scheme`, the effects those of the catalogue, so that a lane's numbers are those of the scalar
step. What stands between two loops is decided for all lanes together: a site none of whose effects acts costs nothing.
`lane_rows` says where everything stands in `block`.
"""

from __future__ import annotations

from eha_core.compiled import bare, called, compiled, inlined, unowned
from eha_core.plant import lane_rows as at
from eha_core.plant.equations import driving_force, external_leakage_flow, hydraulic_force, internal_leakage_flow
from eha_core.plant.ring import rings_in
from eha_core.plant.scheme import (
    coil_current,
    effective_velocity,
    friction_force,
    held_at_the_ends,
    oil_step,
    port_flows,
    spool_step,
    velocity_step,
)
from eha_core.plant.state import COLUMN, STATES

from . import lane_hooks


@called
def schedule_as_stated(block, lanes):
    for lane in range(lanes):
        block[at.INTERNAL_LEAKAGE + lane] = block[at.STATED_LEAKAGE + lane]
        block[at.DAMPING + lane] = block[at.STATED_DAMPING + lane]


@called
def ports_as_stated(block, lanes):
    for lane in range(lanes):
        block[at.GAIN + lane] = block[at.STATED_GAIN + lane]
        block[at.CONDUCTANCE + lane] = 0.0


@called
def chambers_as_stated(block, lanes):
    for lane in range(lanes):
        block[at.AREA_B + lane] = block[at.STATED_AREA_B + lane]
        block[at.BULK_A + lane] = block[at.BULK_B + lane] = block[at.STATED_BULK + lane]
        block[at.BULK_CHANGE_A + lane] = block[at.BULK_CHANGE_B + lane] = 0.0
        block[at.CROSS_SLOPE + lane] = block[at.INTERNAL_LEAKAGE + lane]
        block[at.LEAKAGE_A + lane] = block[at.LEAKAGE_B + lane] = block[at.STATED_EXTERNAL_LEAKAGE + lane]


@called
def piston_as_stated(block, lanes):
    for lane in range(lanes):
        block[at.FORCE + lane] = block[at.STIFFNESS + lane] = block[at.DRY_FRICTION + lane] = 0.0
        block[at.TOTAL_DAMPING + lane] = block[at.DAMPING + lane]


@inlined
def as_stated(block, lanes):
    """Every site as without effects, once: a site's rows change only where an effect of it acts."""
    schedule_as_stated(block, lanes)
    ports_as_stated(block, lanes)
    chambers_as_stated(block, lanes)
    piston_as_stated(block, lanes)


@called
def schedule(block, lanes, active, time):
    """Parameters that change in time, and what follows from them."""
    schedule_as_stated(block, lanes)
    lane_hooks.schedule(block, lanes, active, time)
    chambers_as_stated(block, lanes)
    piston_as_stated(block, lanes)


@called
def valve(block, lanes, active, history, stride, newest, tau):
    """Equations (1) and (2) over one step; then where the spool stands in each half of it. The voltage is the newest in
    the lane's ring, which begins `stride` after that of the lane before."""
    voltage = history[newest]
    for lane in range(lanes):
        block[at.VOLTAGE + lane] = voltage
    if stride:
        for lane in range(lanes):
            block[at.VOLTAGE + lane] = history[lane * stride + newest]
    if active & lane_hooks.COMMAND_EFFECTS:
        lane_hooks.command(block, lanes, active, history, newest, 2.0 * tau)
    for lane in range(lanes):
        current = coil_current(
            block[at.CURRENT + lane], block[at.VOLTAGE + lane], block[at.PROPAGATOR + lane],
            block[at.PROPAGATOR + at.LANES + lane], block[at.SATURATION + lane],
        )  # fmt: skip
        block[at.CURRENT + lane] = current
        block[at.NEW_TARGET + lane] = current
    if active & lane_hooks.SPOOL_EFFECTS:
        lane_hooks.spool(block, lanes, active)
    for lane in range(lanes):
        before, new_target = block[at.SPOOL_POSITION + lane], block[at.NEW_TARGET + lane]
        position, velocity = spool_step(
            before, block[at.SPOOL_VELOCITY + lane], block[at.TARGET + lane], new_target,
            (
                block[at.PROPAGATOR + 2 * at.LANES + lane], block[at.PROPAGATOR + 3 * at.LANES + lane],
                block[at.PROPAGATOR + 4 * at.LANES + lane], block[at.PROPAGATOR + 5 * at.LANES + lane],
                block[at.PROPAGATOR + 6 * at.LANES + lane], block[at.PROPAGATOR + 7 * at.LANES + lane],
                block[at.PROPAGATOR + 8 * at.LANES + lane], block[at.PROPAGATOR + 9 * at.LANES + lane],
            ),
        )  # fmt: skip
        block[at.SPOOL_POSITION + lane], block[at.SPOOL_VELOCITY + lane] = position, velocity
        block[at.TARGET + lane] = new_target
        block[at.OIL_SPOOL + lane] = 0.75 * before + 0.25 * position
        block[at.OIL_SPOOL_NEXT + lane] = 0.25 * before + 0.75 * position


@called
def oil_conditions(block, lanes, active):
    """The sites orifice and chamber, with the spool at OIL_SPOOL and the piston at OIL_POSITION."""
    for lane in range(lanes):
        block[at.OPENING + lane] = block[at.OIL_SPOOL + lane]
        block[at.CROSS_FLOW + lane] = internal_leakage_flow(
            block[at.INTERNAL_LEAKAGE + lane], block[at.PRESSURE_A + lane], block[at.PRESSURE_B + lane]
        )
    if active & lane_hooks.ORIFICE_EFFECTS:
        ports_as_stated(block, lanes)
        lane_hooks.orifice(block, lanes, active)
    if active & lane_hooks.CHAMBER_EFFECTS:
        chambers_as_stated(block, lanes)
        lane_hooks.chamber(block, lanes, active)


@inlined
def lane_ports(block, lane):
    """Equation (3) in one lane."""
    return port_flows(
        block[at.OPENING + lane], block[at.GAIN + lane], block[at.CONDUCTANCE + lane], block[at.PRESSURE_A + lane],
        block[at.PRESSURE_B + lane], block[at.SUPPLY_PRESSURE + lane], block[at.RETURN_PRESSURE + lane],
    )  # fmt: skip


@called
def oil_half_step(block, lanes, active, tau):
    """Equations (3) to (9) over the time tau, the piston at OIL_POSITION and moving steadily at OIL_VELOCITY."""
    oil_conditions(block, lanes, active)
    for lane in range(lanes):
        ports = lane_ports(block, lane)
        chambers = (
            block[at.AREA_B + lane], block[at.BULK_A + lane], block[at.BULK_CHANGE_A + lane], block[at.BULK_B + lane],
            block[at.BULK_CHANGE_B + lane], block[at.CROSS_FLOW + lane], block[at.CROSS_SLOPE + lane],
            block[at.LEAKAGE_A + lane], block[at.LEAKAGE_B + lane],
        )  # fmt: skip
        pressure_a, pressure_b, stiffness = oil_step(
            tau, ports, chambers, block[at.OIL_POSITION + lane], block[at.OIL_VELOCITY + lane],
            block[at.PRESSURE_A + lane], block[at.PRESSURE_B + lane], block[at.AREA_A + lane], block[at.STROKE + lane],
            block[at.LINE + lane], block[at.ATMOSPHERIC_PRESSURE + lane],
        )  # fmt: skip
        block[at.PRESSURE_A + lane], block[at.PRESSURE_B + lane] = pressure_a, pressure_b
        block[at.OIL_STIFFNESS + lane] = stiffness
        block[at.SUPPLY_FLOW + lane], block[at.RETURN_FLOW + lane] = ports[4], ports[5]


@called
def first_half_of_the_way(block, lanes, tau):
    """The piston's first half step, at the speed it has; the oil sees it at the middle of the way."""
    for lane in range(lanes):
        position = block[at.POSITION + lane]
        moving = effective_velocity(tau, position, block[at.VELOCITY + lane], block[at.STROKE + lane])
        block[at.OIL_POSITION + lane], block[at.OIL_VELOCITY + lane] = position + 0.5 * tau * moving, moving
        block[at.POSITION + lane] = position + tau * moving


@called
def piston(block, lanes, active, step_size):
    """Equation (10) over one step at a held position."""
    if active & lane_hooks.FORCE_EFFECTS:
        piston_as_stated(block, lanes)
        lane_hooks.force(block, lanes, active, step_size)
    for lane in range(lanes):
        position, before, spring = block[at.POSITION + lane], block[at.VELOCITY + lane], block[at.SPRING + lane]
        hydraulic = hydraulic_force(
            block[at.AREA_A + lane], block[at.AREA_B + lane], block[at.PRESSURE_A + lane], block[at.PRESSURE_B + lane]
        )
        resistance = (
            block[at.FORCE + lane], block[at.TOTAL_DAMPING + lane], block[at.STIFFNESS + lane],
            block[at.DRY_FRICTION + lane],
        )  # fmt: skip
        velocity = velocity_step(
            step_size, position, before, driving_force(hydraulic, spring, position), resistance,
            block[at.OIL_STIFFNESS + lane], block[at.MASS + lane], spring, block[at.STROKE + lane],
        )  # fmt: skip
        block[at.HYDRAULIC_FORCE + lane], block[at.VELOCITY_BEFORE + lane] = hydraulic, before
        block[at.VELOCITY + lane] = velocity
        block[at.OIL_POSITION + lane] = position + 0.25 * step_size * velocity
        block[at.OIL_VELOCITY + lane] = velocity
        block[at.OIL_SPOOL + lane] = block[at.OIL_SPOOL_NEXT + lane]


@called
def piston_friction(block, lanes, step_size):
    """F_f of equation (10) over the step that `piston` has just taken."""
    for lane in range(lanes):
        driving = driving_force(block[at.HYDRAULIC_FORCE + lane], block[at.SPRING + lane], block[at.POSITION + lane])
        block[at.FRICTION_FORCE + lane] = friction_force(
            step_size, block[at.VELOCITY_BEFORE + lane], block[at.VELOCITY + lane], driving, block[at.DAMPING + lane],
            block[at.STIFFNESS + lane], block[at.OIL_STIFFNESS + lane], block[at.MASS + lane], block[at.SPRING + lane],
        )  # fmt: skip


@called
def second_half_of_the_way(block, lanes, tau):
    """The piston's second half step, and the stroke's ends."""
    for lane in range(lanes):
        velocity = block[at.VELOCITY + lane]
        reached = block[at.POSITION + lane] + tau * velocity
        position, velocity = held_at_the_ends(reached, velocity, block[at.STROKE + lane])
        block[at.POSITION + lane], block[at.VELOCITY + lane] = position, velocity


@called
def supply(block, lanes, active, step_size):
    """The pressures at the valve's supply and return ports, as stated but for their effects."""
    for lane in range(lanes):
        block[at.SUPPLY_PRESSURE + lane] = block[at.STATED_SUPPLY + lane]
        block[at.RETURN_PRESSURE + lane] = block[at.STATED_RETURN + lane]
    lane_hooks.supply(block, lanes, active, step_size)


@called
def see(block, lanes, active, step_size):
    """What the sensors say."""
    for lane in range(lanes):
        block[at.SEEN_POSITION + lane] = block[at.POSITION + lane]
        block[at.SEEN_VELOCITY + lane] = block[at.VELOCITY + lane]
        block[at.SEEN_PRESSURE_A + lane] = block[at.PRESSURE_A + lane]
        block[at.SEEN_PRESSURE_B + lane] = block[at.PRESSURE_B + lane]
    if active & lane_hooks.SENSOR_EFFECTS:
        lane_hooks.sensor(block, lanes, active, step_size)


@called
def write_seen(block, lanes, row):
    """Fill a row (4, lanes) with what the sensors say."""
    for column in range(4):
        for lane in range(lanes):
            row[column, lane] = block[at.SEEN_POSITION + column * at.LANES + lane]


@called
def write_all(block, lanes, active, history, stride, newest, row):
    """Fill a row (COLUMNS, lanes) from the state at the end of a step."""
    for lane in range(lanes):
        block[at.OIL_SPOOL + lane] = block[at.SPOOL_POSITION + lane]
        block[at.OIL_POSITION + lane] = block[at.POSITION + lane]
    oil_conditions(block, lanes, active)
    for lane in range(lanes):
        row[COLUMN.voltage, lane] = history[lane * stride + newest]
        for place in range(STATES):
            row[COLUMN.current + place, lane] = block[at.CURRENT + place * at.LANES + lane]
        row[COLUMN.flow_a, lane], row[COLUMN.flow_b, lane], _, _, _, _ = lane_ports(block, lane)
        row[COLUMN.internal_leakage_flow, lane] = block[at.CROSS_FLOW + lane]
        row[COLUMN.external_leakage_flow_a, lane] = external_leakage_flow(
            block[at.LEAKAGE_A + lane], block[at.PRESSURE_A + lane]
        )
        row[COLUMN.external_leakage_flow_b, lane] = external_leakage_flow(
            block[at.LEAKAGE_B + lane], block[at.PRESSURE_B + lane]
        )
        row[COLUMN.supply_pressure, lane] = block[at.SUPPLY_PRESSURE + lane]
        row[COLUMN.return_pressure, lane] = block[at.RETURN_PRESSURE + lane]
        row[COLUMN.hydraulic_force, lane] = block[at.HYDRAULIC_FORCE + lane]
        row[COLUMN.friction_force, lane] = block[at.FRICTION_FORCE + lane]
        row[COLUMN.internal_leakage, lane] = block[at.INTERNAL_LEAKAGE + lane]
    write_seen(block, lanes, row[COLUMN.measured_position :])


@compiled
def advance(block, lanes, history, active, voltages, step_size, every, rows):
    """Advance every lane of `block` by one step for each of `voltages`, and write a row a lane after `every` of them.

    rows: (rows, columns, lanes); as wide as COLUMNS they take them all, four take what the sensors say. history: as in
    `step.advance`, one for all lanes or, as `ring` has it, one a lane: `voltages` then has one a lane for each step.
    active: the bits of the effects that act in any lane.
    """
    block, history = bare(block), unowned(history)
    width = rings_in(history, step_size)
    size = history.shape[0] // width
    stride = size if width > 1 else 0
    newest, ring = int(history[-1]), size - 1
    time, tau = block[at.TIME], 0.5 * step_size
    everything = rows.shape[1] > 4
    as_stated(block, lanes)
    for index in range(voltages.shape[0] // width):
        newest = newest + 1 if newest + 1 < ring else 0
        history[newest] = voltages[index * width]
        for lane in range(1, width):
            history[lane * stride + newest] = voltages[index * width + lane]
        if active & lane_hooks.SCHEDULE_EFFECTS:
            schedule(block, lanes, active, time + tau)
        valve(block, lanes, active, history, stride, newest, tau)
        first_half_of_the_way(block, lanes, tau)
        oil_half_step(block, lanes, active, tau)
        piston(block, lanes, active, step_size)
        due = (index + 1) % every == 0
        if due and everything:
            piston_friction(block, lanes, step_size)
        oil_half_step(block, lanes, active, tau)
        second_half_of_the_way(block, lanes, tau)
        if active & lane_hooks.SUPPLY_EFFECTS or index == 0:  # what acted before may have left its mark
            supply(block, lanes, active, step_size)
        time += step_size
        if due or active & lane_hooks.SENSOR_EFFECTS:
            see(block, lanes, active, step_size)
        if due and everything:
            write_all(block, lanes, active, history, stride, newest, rows[index // every])
        elif due:
            write_seen(block, lanes, rows[index // every])
    history[-1] = newest
    for lane in range(lanes):
        block[at.TIME + lane] = time


@compiled
def advance_driven(block, lanes, active, pressures_a, pressures_b, step_size, every, rows):
    """Advance position and velocity alone, driven by given chamber pressures held over each step: equation (10)."""
    block = bare(block)
    time, tau = block[at.TIME], 0.5 * step_size
    as_stated(block, lanes)
    for index in range(pressures_a.shape[0]):
        if active & lane_hooks.SCHEDULE_EFFECTS:
            schedule(block, lanes, active, time + tau)
        first_half_of_the_way(block, lanes, tau)
        for lane in range(lanes):
            block[at.PRESSURE_A + lane], block[at.PRESSURE_B + lane] = pressures_a[index], pressures_b[index]
            block[at.OIL_STIFFNESS + lane] = 0.0
        if active & lane_hooks.CHAMBER_EFFECTS:
            oil_conditions(block, lanes, active)
        piston(block, lanes, active, step_size)
        second_half_of_the_way(block, lanes, tau)
        time += step_size
        due = (index + 1) % every == 0
        if due or active & lane_hooks.SENSOR_EFFECTS:
            see(block, lanes, active, step_size)
        if due:
            write_seen(block, lanes, rows[index // every])
    for lane in range(lanes):
        block[at.TIME + lane] = time
