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
            name="moment_of_inertia", symbol="J", unit="kg m^2", nominal=0.5, lower=1e-5, upper=1e5,
            meaning="moment of inertia of vane, shaft and load", source=ASSUMED,
            typical=0.5, logarithmic=True,
        ),
        Parameter(
            name="rotational_damping", symbol="B_r", unit="N m s/rad", nominal=10.0, lower=0.0, upper=1e7,
            meaning="viscous damping of vane and load", source=ASSUMED,
            typical=10.0,
        ),
        Parameter(
            name="rotational_stiffness", symbol="K_r", unit="N m/rad", nominal=0.0, lower=0.0, upper=1e8,
            meaning="stiffness of the spring that the load turns",
            source=ASSUMED,
        ),
    ),
    stands_for={
        "moment_of_inertia": ("moving_mass",),
        "rotational_damping": ("damping_coefficient",),
        "rotational_stiffness": ("spring_stiffness",),
    },
    motion="rad",
)  # fmt: skip
