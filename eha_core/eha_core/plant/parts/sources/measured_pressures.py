"""Measured pressures in both chambers: they drive the piston, whatever the oil does to bring them about.

Equation: (10) with P1 and P2 given, held over each step: M_p x_p'' = A_p P1 - A_b P2 - B_s x_p' - K_s x_p - F_f.
Sign: pressure in chamber A extends.
Validity: pressures measured at the chambers, sampled well above what the load's inertia lets through.
Source: Shern, Ghazali, Soon, Sam, Rahmat, "Position Tracking Performance for Electro-Hydraulic Actuator System with the
Presence of Actuator Internal Leakage", equation (10).
"""

from eha_core.plant.parts.declaration import CONTINUITY, Source

PART = Source(
    summary="measured pressures in both chambers",
    inputs=("pressure_a", "pressure_b"),
    given="pressures",
    sites=("force", "sensor"),
    ignores=CONTINUITY,
    hides=(
        "voltage", "current", "spool_position", "spool_velocity", "flow_a", "flow_b", "internal_leakage_flow",
        "external_leakage_flow_a", "external_leakage_flow_b", "supply_pressure", "return_pressure", "internal_leakage",
        "measured_pressure_a", "measured_pressure_b",
    ),
)  # fmt: skip
