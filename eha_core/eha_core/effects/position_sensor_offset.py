"""Position sensor whose zero is not at the middle of the stroke.

Signature: the spring's rest, the stroke's ends and the chambers' equal volumes lie off the measured zero, all by one
length; speeds are right.
Equation: y = x_p + offset.
Sign: a positive offset reads too far towards extension.
Validity: constant offset; the sensor's gain is right.
Source: E. O. Doebelin, Measurement Systems, McGraw-Hill 1966, chapter 3 (static calibration).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="sensor",
    statement="the position sensor's zero lies {offset:+4} off the middle of the stroke",
    equation="y = x_p + offset",
    parameters=(
        Parameter(
            name="offset",
            symbol="y_0",
            unit="m",
            nominal=0.0,
            lower=-10.0,
            upper=10.0,
            meaning="reading at the middle of the stroke",
            source=ASSUMED,
            typical=0.02,
            switches=True,
            starts=(-1.0, 1.0),
        ),
    ),
    # the sensor's gain error is in its own reading, zero included
    order=3,
    # by position and force alone it is a load on the spring
    needs=("measured_pressure_a",),
    zeros=(("offset", "position"),),
)


@inlined
def contribution(position, velocity, pressure_a, pressure_b, memory, slot, step_size, offset):
    """Shift the position."""
    return position + offset, velocity, pressure_a, pressure_b
