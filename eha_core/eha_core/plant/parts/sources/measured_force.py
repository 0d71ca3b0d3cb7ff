"""A measured force on the load: a load cell, or whatever else moves it in place of oil.

Equation: (10) with A_p P1 - A_b P2 given, held over each step: M_p x_p'' = F - B_s x_p' - K_s x_p - F_f.
Sign: a positive force extends.
Validity: a force measured between actuator and load, the moving mass being what lies beyond the cell.
Source: Shern, Ghazali, Soon, Sam, Rahmat, "Position Tracking Performance for Electro-Hydraulic Actuator System with the
Presence of Actuator Internal Leakage", equation (10).
"""

from eha_core.plant.parts.declaration import CONTINUITY, Source

PART = Source(
    summary="a measured force",
    inputs=("force",),
    given="force",
    sites=("force", "sensor"),
    ignores=(*CONTINUITY, "piston_area", "piston_area_b"),
    hides=(
        "voltage", "current", "spool_position", "spool_velocity", "pressure_a", "pressure_b", "flow_a", "flow_b",
        "internal_leakage_flow", "external_leakage_flow_a", "external_leakage_flow_b", "supply_pressure",
        "return_pressure", "internal_leakage", "measured_pressure_a", "measured_pressure_b",
    ),
)  # fmt: skip
