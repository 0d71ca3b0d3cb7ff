"""A rotary vane actuator: the chambers on either side of a vane on a shaft.

Equation: as the double rod's, with the displacement per radian D_v for both areas and the angle for the position:
V_A = V_line + D_v (theta_s + theta), V_B = V_line + D_v (theta_s - theta); the pressures' torque is D_v (P1 - P2).
Sign: the angle grows as chamber A fills; it is zero midway between the stops.
Validity: a vane of constant section. Positions, velocities and forces are angles [rad], their rates and torques [N m].
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 6 (rotary actuators as motors of limited travel).
"""

from eha_core.effects.declaration import ASSUMED
from eha_core.parameter import Parameter
from eha_core.plant.parts.declaration import CONTINUITY, Cylinder

PART = Cylinder(
    summary="a rotary vane actuator",
    uses=CONTINUITY,
    parameters=(
        Parameter(
            name="vane_displacement", symbol="D_v", unit="m^3/rad", nominal=5e-5, lower=1e-6, upper=1.0,
            meaning="oil that each chamber takes or gives per radian",
            source=ASSUMED, typical=5e-5, logarithmic=True,
        ),
        Parameter(
            name="half_travel", symbol="theta_s", unit="rad", nominal=1.5, lower=1e-3, upper=10.0,
            meaning="angle from the middle to either stop", source=ASSUMED,
            typical=1.5, logarithmic=True,
        ),
    ),
    stands_for={"vane_displacement": ("piston_area", "piston_area_b"), "half_travel": ("actuator_displacement",)},
    motion="rad",
)  # fmt: skip
