"""Gain error of the pressure sensors, each its own.

Signature: one chamber's measured pressure swings in one proportion too far for the other's and for the piston's motion;
unlike an offset's, the error vanishes with the pressure.
Equation: measured P1 = (1 + ratio_a) P1, measured P2 = (1 + ratio_b) P2.
Sign: a positive ratio reads too high.
Validity: linear sensors whose zeros are right. One that reads less than half or more than twice is of another range or
unit.
Source: E. O. Doebelin, Measurement Systems, McGraw-Hill 1966, chapter 3 (static calibration).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="sensor",
    statement="the pressure sensors' gains are off: chamber A's by {ratio_a:+%}, chamber B's by {ratio_b:+%}",
    equation="measured P1 = (1 + ratio_a) P1, measured P2 = (1 + ratio_b) P2",
    parameters=(
        Parameter(
            name="ratio_a",
            symbol="r_1",
            unit="-",
            nominal=0.0,
            lower=-0.5,
            upper=1.0,
            meaning="gain error of chamber A's sensor",
            source=ASSUMED,
            typical=0.08,
            switches=True,
            starts=(1.0, 0.0),
        ),
        Parameter(
            name="ratio_b",
            symbol="r_2",
            unit="-",
            nominal=0.0,
            lower=-0.5,
            upper=1.0,
            meaning="gain error of chamber B's sensor",
            source=ASSUMED,
            typical=-0.06,
            switches=True,
            starts=(1.0, 0.0),
        ),
    ),
    # before the offset, which is in the sensor's own reading
    order=2,
    needs=("measured_pressure_a",),
)


@inlined
def contribution(position, velocity, pressure_a, pressure_b, memory, slot, step_size, ratio_a, ratio_b):
    """Scale both pressures."""
    return position, velocity, pressure_a * (1.0 + ratio_a), pressure_b * (1.0 + ratio_b)
