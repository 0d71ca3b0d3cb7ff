"""Null shift of the valve: at zero current the ports are already open a little.

Signature: the piston creeps at zero command, the same way all the time, whatever the load.
Equation: opening = x_v + offset.
Sign: a positive offset opens towards extension.
Validity: constant shift; a null that wanders with temperature or supply pressure is not this.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 7 (null shift of servo valves).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="orifice",
    statement="the valve's null is shifted: it acts as if the spool stood {offset} off",
    equation="opening = x_v + offset",
    parameters=(
        Parameter(
            name="offset",
            symbol="x_0",
            unit="A",
            nominal=0.0,
            lower=-0.02,
            upper=0.02,
            meaning="opening at zero spool position",
            source=ASSUMED,
            typical=2e-5,
            switches=True,
            relative_to="spool",
            starts=(-0.1, 0.1),
        ),
    ),
    order=0,
)


@inlined
def contribution(opening, gain, conductance, spool_position, offset):
    """Shift the opening."""
    return opening + offset, gain, conductance
