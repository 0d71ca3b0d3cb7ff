"""Internal leakage that depends on position: a stretch of the bore that is worn.

Signature: the piston loses speed under load in one part of the stroke, as with a larger internal leakage there alone.
Equation: q12 += coefficient sech^2((x_p - centre) / width) (P1 - P2).
Sign: positive from chamber A to B where A's pressure is higher.
Validity: laminar flow; one stretch, alike on both sides of its middle. The flow is 42 % of its highest at one width
from the centre and 7 % at two. A stretch much wider than the travel is more internal leakage, and is not seen.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 3 (laminar flow past a piston, with the cube of
the clearance). The bell over the position is assumed: it lies between a Gaussian and what a clearance with a Gaussian
groove lets through.
"""

from eha_core.compiled import inlined
from eha_core.decay import decayed
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="chamber",
    approximate=True,
    statement="the bore is worn near {centre:4}: oil passes the piston there, {coefficient} at most, less than half "
    "of it {width} away",
    equation="q12 += coefficient sech^2((x_p - centre)/width) (P1 - P2)",
    parameters=(
        Parameter(
            name="coefficient",
            symbol="K_w",
            unit="m^3/(s Pa)",
            nominal=0.0,
            lower=0.0,
            upper=1e-7,
            meaning="internal leakage added at the centre",
            source=ASSUMED,
            typical=1e-10,
            switches=True,
            relative_to="leakage_flow",
            starts=(0.3,),
        ),
        Parameter(
            name="centre",
            symbol="x_w",
            unit="m",
            nominal=0.0,
            lower=-10.0,
            upper=10.0,
            meaning="position at which the bore is worn most",
            source=ASSUMED,
            typical=0.005,
            relative_to="position",
            starts=(-0.6, 0.0, 0.6),
        ),
        Parameter(
            name="width",
            symbol="w_w",
            unit="m",
            nominal=0.01,
            lower=1e-5,
            upper=10.0,
            meaning="distance from the centre at which 42 % of it is left",
            source=ASSUMED,
            typical=0.01,
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
    centre,
    width,
):
    """Add a conductance that depends on where the piston is."""
    fallen = decayed(2.0 * abs((position - centre) / width))
    conductance = coefficient * 4.0 * fallen / ((1.0 + fallen) * (1.0 + fallen))
    cross_flow += conductance * (pressure_a - pressure_b)
    cross_slope += conductance
    return area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross_flow, cross_slope, leakage_a, leakage_b
