"""A mass on a spring, with viscous damping: the paper's.

Equation: (10): M_p x_p'' = A_p P1 - A_b P2 - B_s x_p' - K_s x_p - F_f.
Sign: the spring pulls towards mid stroke.
Validity: a load rigidly coupled to the rod.
Source: Shern, Ghazali, Soon, Sam, Rahmat, "Position Tracking Performance for Electro-Hydraulic Actuator System with the
Presence of Actuator Internal Leakage", equation (10).
"""

from eha_core.plant.parts.declaration import Load

PART = Load(
    summary="a sprung mass",
    uses=("spring_stiffness", "moving_mass", "damping_coefficient"),
)
