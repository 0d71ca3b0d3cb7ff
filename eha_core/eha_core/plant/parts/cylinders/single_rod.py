"""A cylinder with one rod, in chamber B: a differential cylinder, stronger extending than retracting.

Equation: as the double rod's with A_b < A_p: steadily x_p' = Q1 / A_p = Q2 / A_b, and A_p P1 = A_b P2 without a load.
It starts at rest, with P1 + P2 = P_s + P_r and the pressures' force in balance with the spring's.
Sign: the position grows as chamber A, on the head's side, fills; it is zero at mid stroke.
Validity: rigid walls; lines of one volume at both ports.
Source: M. Jelali, A. Kroll, Hydraulic Servo-systems, Springer 2003, chapter 4 (differential cylinders).
"""

from collections.abc import Mapping

from eha_core.errors import ParameterError
from eha_core.parameter import Parameter
from eha_core.plant.parts.declaration import CONTINUITY, Cylinder


def check(values: Mapping[str, float]) -> None:
    """The rod takes some of chamber B's area."""
    if not values["piston_area_b"] < values["piston_area"]:
        raise ParameterError(
            f"piston_area_b = {values['piston_area_b']:g} m^2 is not below piston_area = {values['piston_area']:g} m^2,"
            " and a single_rod cylinder has its rod in chamber B; give the annulus, or swap A and B"
        )


PART = Cylinder(
    summary="a single-rod cylinder",
    uses=(*CONTINUITY, "piston_area", "actuator_displacement"),
    parameters=(
        Parameter(
            name="piston_area_b", symbol="A_b", unit="m^2", nominal=430e-6, lower=1e-6, upper=1.0,
            meaning="annular area towards chamber B, where the rod is",
            source="assumed: two thirds of Table 1's area", typical=430e-6, logarithmic=True,
        ),
    ),
    balanced=True,
    check=check,
)  # fmt: skip
