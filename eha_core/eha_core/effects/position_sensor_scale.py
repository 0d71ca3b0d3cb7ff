"""Gain error of the position sensor.

Signature: measured strokes and speeds are in one proportion too long or too short for the oil that was pressed in.
Equation: y = (1 + ratio) x_p, and so for the velocity.
Sign: a positive ratio reads too long.
Validity: a linear sensor with its zero at the stroke's middle. What it shows is also shown by a plant whose valve gain,
leakage and volumes are larger by 1 + ratio and whose mass, damping and spring are smaller: only how well these are
known tells them apart.
Source: E. O. Doebelin, Measurement Systems, McGraw-Hill 1966, chapter 3 (static calibration).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="sensor",
    statement="the position sensor reads {ratio:%} too long",
    opposite="the position sensor reads {ratio:%} too short",
    equation="y = (1 + ratio) x_p",
    parameters=(
        Parameter(
            name="ratio",
            symbol="r_y",
            unit="-",
            nominal=0.0,
            lower=-0.9,
            upper=9.0,
            meaning="gain error",
            source=ASSUMED,
            typical=0.05,
            switches=True,
            starts=(-1.0, 1.0),
        ),
    ),
    order=2,
    # by position and force alone it is a lighter or heavier piston, less or more damped
    needs=("measured_pressure_a",),
)


@inlined
def contribution(position, velocity, pressure_a, pressure_b, memory, slot, step_size, ratio):
    """Scale position and velocity."""
    gain = 1.0 + ratio
    return gain * position, gain * velocity, pressure_a, pressure_b
