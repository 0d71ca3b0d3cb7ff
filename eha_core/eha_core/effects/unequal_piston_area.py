"""A rod on one side: chamber B's piston area differs from the one that the parameters state.

Signature: extension and retraction differ in speed and in pressure, and the pressures at rest are not equal.
Equation: A_b -> ratio A_b in (5) and (10); with Table 1's symmetric cylinder, A_b = ratio A_a.
Sign: a ratio below 1 means a rod in chamber B.
Validity: any cylinder; the volume of chamber B changes with its area.
Source: M. Jelali, A. Kroll, Hydraulic Servo-systems, Springer 2003, chapter 4 (differential cylinders).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="chamber",
    statement="the piston's areas differ: chamber B's is {ratio:%} of what was taken for it",
    equation="A_b -> ratio A_b",
    parameters=(
        Parameter(
            name="ratio",
            symbol="r_A",
            unit="-",
            nominal=1.0,
            lower=0.05,
            upper=5.0,
            meaning="chamber B's piston area over the stated one",
            source=ASSUMED,
            typical=0.85,
            switches=True,
            starts=(1.0, 1.3),
        ),
    ),
)


@inlined
def contribution(
    area_b,
    bulk_a,
    bulk_change_a,
    bulk_b,
    bulk_change_b,
    cross_flow,
    cross_slope,
    leakage_a,
    leakage_b,
    position,
    pressure_a,
    pressure_b,
    atmospheric_pressure,
    ratio,
):
    """Scale chamber B's area."""
    area_b *= ratio
    return area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross_flow, cross_slope, leakage_a, leakage_b
