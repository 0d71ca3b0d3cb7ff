"""A valve whose spool position is measured: it drives the flow in place of coil, amplifier and spool dynamics.

Equation: (3) with x_v given, held over each step.
Sign: a positive spool position lets oil into chamber A.
Validity: any valve of symmetric ports whose spool is measured, the valve gain being per unit of what is measured.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 5 (flow of a critical-centre four-way valve).
"""

from eha_core.compiled import inlined
from eha_core.plant.parts.declaration import Source
from eha_core.plant.scheme import port_flows

PART = Source(
    summary="a valve of measured spool position",
    uses=("valve_gain", "supply_pressure", "return_pressure"),
    inputs=("spool",),
    valve="spool",
    sites=("orifice", "supply", "chamber", "force", "sensor", "schedule"),
    hides=("voltage", "current", "spool_velocity"),
)


@inlined
def contribution(
    opening, gain, conductance, first, second, pressure_a, pressure_b, supply_pressure, return_pressure
):  # fmt: skip
    """Equation (3)."""
    return port_flows(opening, gain, conductance, pressure_a, pressure_b, supply_pressure, return_pressure)
