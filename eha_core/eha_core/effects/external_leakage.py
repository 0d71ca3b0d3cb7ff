"""Leakage of each chamber to the outside: rod seals, fittings, a bypass to the tank.

Signature: the pressures fall below half of supply plus return, and the piston yields to the side that leaks.
Equation: q1 = (K_Lex + coefficient_a) P1, q2 = (K_Lex + coefficient_b) P2.
Sign: positive leaves the chamber.
Validity: laminar flow through narrow gaps; constant viscosity.
Source: equations (8) and (9) of the model's paper; H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 3.
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="chamber",
    statement="oil leaks to the outside: {coefficient_a} from chamber A, {coefficient_b} from chamber B",
    equation="q1 += coefficient_a P1, q2 += coefficient_b P2",
    parameters=(
        Parameter(
            name="coefficient_a",
            symbol="K_a",
            unit="m^3/(s Pa)",
            nominal=0.0,
            lower=0.0,
            upper=1e-7,
            meaning="leakage of chamber A",
            source=ASSUMED,
            typical=1e-12,
            switches=True,
            relative_to="leakage_flow",
            starts=(0.0, 0.05),
        ),
        Parameter(
            name="coefficient_b",
            symbol="K_b",
            unit="m^3/(s Pa)",
            nominal=0.0,
            lower=0.0,
            upper=1e-7,
            meaning="leakage of chamber B",
            source=ASSUMED,
            typical=5e-13,
            switches=True,
            relative_to="leakage_flow",
            starts=(0.0, 0.05),
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
    coefficient_a,
    coefficient_b,
):
    """Add to what each chamber loses."""
    leakage_a += coefficient_a
    leakage_b += coefficient_b
    return area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross_flow, cross_slope, leakage_a, leakage_b
