"""A servo valve whose coil current is measured: the current drives it in place of coil and amplifier.

Equation: (2) and (3) with the current given, held over each step: x_v'' + 2 xi w x_v' + w^2 x_v = w^2 I.
Sign: a positive current lets oil into chamber A.
Validity: a current measured at the coil itself, sampled well above the spool's natural frequency.
Source: Shern, Ghazali, Soon, Sam, Rahmat, "Position Tracking Performance for Electro-Hydraulic Actuator System with the
Presence of Actuator Internal Leakage", equations (2) and (3).
"""

from eha_core.compiled import inlined
from eha_core.plant.parts.declaration import Source
from eha_core.plant.scheme import port_flows

PART = Source(
    summary="a servo valve of measured current",
    uses=("valve_damping_ratio", "valve_natural_frequency", "valve_gain", "supply_pressure", "return_pressure"),
    inputs=("current",),
    valve="current",
    sites=("spool", "orifice", "supply", "chamber", "force", "sensor", "schedule"),
    hides=("voltage",),
)


@inlined
def contribution(
    opening, gain, conductance, first, second, pressure_a, pressure_b, supply_pressure, return_pressure
):  # fmt: skip
    """Equation (3)."""
    return port_flows(opening, gain, conductance, pressure_a, pressure_b, supply_pressure, return_pressure)
