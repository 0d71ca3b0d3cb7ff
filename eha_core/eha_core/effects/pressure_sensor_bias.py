"""Offset of a pressure sensor.

Signature: the measured pressures balance no force at rest, by the same amount at any load.
Equation: measured P1 = P1 + bias_a, measured P2 = P2 + bias_b.
Sign: a positive bias reads too high.
Validity: constant offset; the sensors' gains are right.
Source: E. O. Doebelin, Measurement Systems, McGraw-Hill 1966, chapter 3 (static calibration).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="sensor",
    statement="the pressure sensors are off: chamber A's by {bias_a}, chamber B's by {bias_b}",
    equation="measured P1 = P1 + bias_a, measured P2 = P2 + bias_b",
    parameters=(
        Parameter(
            name="bias_a",
            symbol="b_1",
            unit="Pa",
            nominal=0.0,
            lower=-1e7,
            upper=1e7,
            meaning="offset of chamber A's sensor",
            source=ASSUMED,
            typical=3e5,
            switches=True,
            starts=(1.0, 0.0),
        ),
        Parameter(
            name="bias_b",
            symbol="b_2",
            unit="Pa",
            nominal=0.0,
            lower=-1e7,
            upper=1e7,
            meaning="offset of chamber B's sensor",
            source=ASSUMED,
            typical=-2e5,
            switches=True,
            starts=(1.0, 0.0),
        ),
    ),
    order=3,
    needs=("measured_pressure_a",),
    zeros=(("bias_a", "pressure_a"), ("bias_b", "pressure_b")),
)


@inlined
def contribution(position, velocity, pressure_a, pressure_b, memory, slot, step_size, bias_a, bias_b):
    """Shift both pressures."""
    return position, velocity, pressure_a + bias_a, pressure_b + bias_b
