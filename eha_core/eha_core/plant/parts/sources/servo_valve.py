"""A servo valve driven by a voltage, between a supply of constant pressure and a return line: the paper's.

Equation: (1) to (3): the coil's current follows the voltage, the spool the current, and x_v opens both ports alike,
Q1 = K x_v sqrt(P_s - P1), Q2 = K x_v sqrt(P2 - P_r), and the other way round for x_v < 0.
Sign: a positive voltage lets oil into chamber A.
Validity: a symmetric valve of matched lands; a supply that holds its pressure.
Source: Shern, Ghazali, Soon, Sam, Rahmat, "Position Tracking Performance for Electro-Hydraulic Actuator System with the
Presence of Actuator Internal Leakage", equations (1) to (3).
"""

from eha_core.compiled import inlined
from eha_core.plant.parts.declaration import Source
from eha_core.plant.scheme import port_flows

PART = Source(
    summary="a servo valve on voltage",
    uses=(
        "coil_resistance", "coil_inductance", "saturation_current", "valve_damping_ratio", "valve_natural_frequency",
        "valve_gain", "supply_pressure", "return_pressure",
    ),
    inputs=("voltage_command",),
    valve="coil",
    sites=("command", "spool", "orifice", "supply", "chamber", "force", "sensor", "schedule"),
)  # fmt: skip


@inlined
def contribution(
    opening, gain, conductance, first, second, pressure_a, pressure_b, supply_pressure, return_pressure
):  # fmt: skip
    """Equation (3)."""
    return port_flows(opening, gain, conductance, pressure_a, pressure_b, supply_pressure, return_pressure)
