"""A cylinder with a rod on both sides: the paper's.

Equation: V_A = V_line + A_p (x_s + x_p), V_B = V_line + A_b (x_s - x_p); the pressures' force is A_p P1 - A_b P2.
Sign: the position grows as chamber A fills; it is zero at mid stroke.
Validity: rigid walls; lines of one volume at both ports.
Source: Shern, Ghazali, Soon, Sam, Rahmat, "Position Tracking Performance for Electro-Hydraulic Actuator System with the
Presence of Actuator Internal Leakage", equations (4) to (10).
"""

from eha_core.plant.parts.declaration import CONTINUITY, Cylinder

PART = Cylinder(
    summary="a double-rod cylinder",
    uses=(*CONTINUITY, "piston_area", "piston_area_b", "actuator_displacement"),
)
