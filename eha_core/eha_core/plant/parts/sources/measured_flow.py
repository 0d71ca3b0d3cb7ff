"""Measured flows into chamber A and out of chamber B, whatever makes them.

Equation: Q1 and Q2 of (4) and (5) given, held over each step; no pressure acts back on them.
Sign: flow_a is positive into chamber A, flow_b positive out of chamber B, so that both are positive while the piston
extends.
Validity: flows measured at the ports. What the two meters read beyond A_p v and A_b v stays in the chambers as pressure
until leakage lets it out: an offset of either meter drives the pressures away, as it would in the rig's own continuity.
Source: M. Jelali, A. Kroll, Hydraulic Servo-systems, Springer 2003, chapter 4 (continuity of the cylinder's chambers).
"""

from eha_core.compiled import inlined
from eha_core.plant.parts.declaration import Source

PART = Source(
    summary="measured flows at both ports",
    uses=("supply_pressure", "return_pressure"),
    inputs=("flow_a", "flow_b"),
    hides=("voltage", "current", "spool_position", "spool_velocity"),
)


@inlined
def contribution(
    opening, gain, conductance, first, second, pressure_a, pressure_b, supply_pressure, return_pressure
):  # fmt: skip
    """The flows as they are given, stiff against the pressures."""
    return first, second, 0.0, 0.0, 0.0, 0.0
