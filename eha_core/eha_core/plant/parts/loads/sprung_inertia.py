"""A rotating inertia on a torsion spring, with viscous damping: what a rotary actuator turns.

Equation: J theta'' = T - B_r theta' - K_r theta - T_f, which is (10) with J, B_r and K_r for M_p, B_s and K_s.
Sign: the spring turns towards the middle.
Validity: a load rigidly coupled to the shaft.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 6 (valve-controlled motor with inertia load).
"""

from eha_core.effects.declaration import ASSUMED
from eha_core.parameter import Parameter
from eha_core.plant.parts.declaration import Load

PART = Load(
    summary="a sprung inertia",
    parameters=(
        Parameter(
            "moment_of_inertia", "J", "kg m^2", 0.5, 1e-5, 1e5, "moment of inertia of vane, shaft and load", ASSUMED,
            typical=0.5, logarithmic=True,
        ),
        Parameter(
            "rotational_damping", "B_r", "N m s/rad", 10.0, 0.0, 1e7, "viscous damping of vane and load", ASSUMED,
            typical=10.0,
        ),
        Parameter(
            "rotational_stiffness", "K_r", "N m/rad", 0.0, 0.0, 1e8, "stiffness of the spring that the load turns",
            ASSUMED,
        ),
    ),
    stands_for={
        "moment_of_inertia": ("moving_mass",),
        "rotational_damping": ("damping_coefficient",),
        "rotational_stiffness": ("spring_stiffness",),
    },
    motion="rad",
)  # fmt: skip
