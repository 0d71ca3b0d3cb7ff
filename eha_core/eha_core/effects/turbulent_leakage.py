"""Turbulent leakage between the chambers: a worn or torn piston seal that acts as an orifice.

Signature: the piston loses speed under load, less than in proportion as the load grows.
Equation: q12 += coefficient sign(P1 - P2) sqrt|P1 - P2|; laminar, and smooth, below the transition pressure.
Sign: positive from chamber A to B where A's pressure is higher.
Validity: a sharp-edged gap; Reynolds numbers past the transition.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 3 (orifice flow). The transition's form is
assumed.
"""

from math import sqrt

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="chamber",
    approximate=True,
    statement="oil passes the piston as through an orifice: {coefficient}",
    equation="q12 += coefficient sign(P1 - P2) sqrt|P1 - P2|",
    parameters=(
        Parameter(
            name="coefficient",
            symbol="C_t",
            unit="m^3/(s Pa^0.5)",
            nominal=0.0,
            lower=0.0,
            upper=1e-5,
            meaning="flow per root of the pressure difference",
            source=ASSUMED,
            typical=3e-8,
            switches=True,
            starts=(0.3, 3.0),
        ),
        Parameter(
            name="transition_pressure",
            symbol="p_t",
            unit="Pa",
            nominal=1e3,
            lower=1e2,
            upper=1e5,
            meaning="difference below which the flow turns laminar",
            source=ASSUMED,
            typical=1e3,
            logarithmic=True,
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
    coefficient,
    transition_pressure,
):
    """Add d / (d^2 + p^2)^(1/4) for the root of the difference d, p the transition pressure, and its derivative."""
    difference = pressure_a - pressure_b
    square = difference * difference + transition_pressure * transition_pressure
    root = sqrt(sqrt(square))
    cross_flow += coefficient * difference / root
    cross_slope += coefficient * (1.0 - 0.5 * difference * difference / square) / root
    return area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross_flow, cross_slope, leakage_a, leakage_b
