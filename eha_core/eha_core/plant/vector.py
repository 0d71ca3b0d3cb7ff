"""Where each nominal parameter stands in the vector that compiled functions see: the order of `parameters.NOMINAL`."""

from __future__ import annotations

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
