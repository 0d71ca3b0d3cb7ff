"""What the plant's numbers are called: its state, a row of what it reports, and where the compiled step keeps both."""

from __future__ import annotations

from typing import NamedTuple


class State(NamedTuple):
    """The continuous state of equations (1) to (10). Pressures are above the return line's reference.

    Attributes:
        current: of the coil [A].
        spool_position: in ampere-equivalent [A]: it settles at the current.
        spool_velocity: [A/s].
        position: of the piston, zero at mid stroke [m].
        velocity: of the piston [m/s].
        pressure_a: in chamber A, P1 [Pa].
        pressure_b: in chamber B, P2 [Pa].
    """

    current: float
    spool_position: float
    spool_velocity: float
    position: float
    velocity: float
    pressure_a: float
    pressure_b: float


STATES = len(State._fields)


class Row(NamedTuple):
    """One row of what the plant reports. SI units; pressures above the return line's reference.

    Flows: into port A, out of port B, from chamber A to B through the piston's seal, out of each chamber to the
    outside. `friction_force` is F_f of equation (10): all on the piston beside pressure, viscous damping and spring,
    the reaction of the stroke's ends included. `internal_leakage` is the coefficient K_Lin in force. `measured_*` is
    what sensors say.
    """

    voltage: float
    current: float
    spool_position: float
    spool_velocity: float
    position: float
    velocity: float
    pressure_a: float
    pressure_b: float
    flow_a: float
    flow_b: float
    internal_leakage_flow: float
    external_leakage_flow_a: float
    external_leakage_flow_b: float
    supply_pressure: float
    return_pressure: float
    hydraulic_force: float
    friction_force: float
    internal_leakage: float
    measured_position: float
    measured_velocity: float
    measured_pressure_a: float
    measured_pressure_b: float


COLUMNS = Row._fields
SEEN = COLUMNS[-4:]
"""What the sensors say: the columns that cost least."""

COLUMN = Row(*range(len(COLUMNS)))
"""Where each column stands in a row, for compiled functions: `row[COLUMN.flow_a]`."""


class Places(NamedTuple):
    """What the compiled step hands to its next call, each at its place in one array.

    `target` is the current that the spool followed last; supply and return pressure are those in force; then come the
    fields of `State`.
    """

    time: int
    target: int
    supply_pressure: int
    return_pressure: int
    current: int
    spool_position: int
    spool_velocity: int
    position: int
    velocity: int
    pressure_a: int
    pressure_b: int


AT = Places(*range(len(Places._fields)))
"""`state[AT.position]`."""

PISTON = slice(AT.position, AT.pressure_b + 1)
"""Position, velocity and both pressures within that array: what a measurement can restart."""
