"""Where the numbers of plants that advance in lock-step stand in their common block.

The block is one array of rows, a quantity each and a lane for each plant: lane k of a row is at the row's place + k.
One array, and places that are known when it is compiled, is what lets the compiler take all lanes at once: it sees that
no two rows overlap.
"""

from __future__ import annotations

from eha_core.plant import vector

REGISTER = 8
"""Lanes are filled up to a multiple of this: what the compiler takes at once with AVX-512, and in two with AVX2. Those
left over go one by one, and four of them take longer than eight."""

LANES = 24
"""Places for plants in a block: registers enough to keep the divider busy, and for a Jacobian of 23 columns."""

# the first eleven are those of `state.Places`
(
    TIME, TARGET, SUPPLY_PRESSURE, RETURN_PRESSURE, CURRENT, SPOOL_POSITION, SPOOL_VELOCITY, POSITION, VELOCITY,
    PRESSURE_A, PRESSURE_B,
    # what the hooks of the sites read and change
    VOLTAGE, INTERNAL_LEAKAGE, DAMPING, NEW_TARGET, OPENING, GAIN, CONDUCTANCE, AREA_B, BULK_A, BULK_CHANGE_A, BULK_B,
    BULK_CHANGE_B, CROSS_FLOW, CROSS_SLOPE, LEAKAGE_A, LEAKAGE_B, FORCE, TOTAL_DAMPING, STIFFNESS, DRY_FRICTION,
    SEEN_POSITION, SEEN_VELOCITY, SEEN_PRESSURE_A, SEEN_PRESSURE_B, SUPPLY_FLOW, RETURN_FLOW,
    # what one piece of the step leaves to the next
    OIL_SPOOL, OIL_SPOOL_NEXT, OIL_POSITION, OIL_VELOCITY, OIL_STIFFNESS, HYDRAULIC_FORCE, FRICTION_FORCE,
    VELOCITY_BEFORE, PROPAGATOR,
) = range(0, 46 * LANES, LANES)  # fmt: skip

PARAMETERS = PROPAGATOR + 10 * LANES
"""From here on the parameters, in the order of the catalogue; then the effects' memory, then which effects act."""

SATURATION = PARAMETERS + vector.SATURATION_CURRENT * LANES
STATED_GAIN = PARAMETERS + vector.VALVE_GAIN * LANES
STATED_BULK = PARAMETERS + vector.BULK_MODULUS * LANES
STATED_SUPPLY = PARAMETERS + vector.SUPPLY_PRESSURE * LANES
STATED_RETURN = PARAMETERS + vector.RETURN_PRESSURE * LANES
SPRING = PARAMETERS + vector.SPRING_STIFFNESS * LANES
STROKE = PARAMETERS + vector.ACTUATOR_DISPLACEMENT * LANES
AREA_A = PARAMETERS + vector.PISTON_AREA * LANES
STATED_AREA_B = PARAMETERS + vector.PISTON_AREA_B * LANES
MASS = PARAMETERS + vector.MOVING_MASS * LANES
STATED_DAMPING = PARAMETERS + vector.DAMPING_COEFFICIENT * LANES
STATED_LEAKAGE = PARAMETERS + vector.INTERNAL_LEAKAGE * LANES
STATED_EXTERNAL_LEAKAGE = PARAMETERS + vector.EXTERNAL_LEAKAGE * LANES
LINE = PARAMETERS + vector.LINE_VOLUME * LANES
ATMOSPHERIC_PRESSURE = PARAMETERS + vector.ATMOSPHERIC_PRESSURE * LANES
