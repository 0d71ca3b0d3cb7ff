"""Leakage over worn lands about null: laminar flow from supply to port and from port to return.

Signature: at small commands both pressures are drawn to the middle between supply and return and the piston yields to
load; at large commands all is as before.
Equation: Q += G (P_s - P) - G (P - P_r) at each port, G = conductance exp(-|x_v| / width).
Sign: positive conductance lets oil through.
Validity: rounded edges and radial clearance, alike at the four lands; oil of constant viscosity.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 5 (null leakage of spool valves); B. Eryilmaz,
B. H. Wilson, "Unified modeling and analysis of a proportional valve", Journal of the Franklin Institute 343 (2006). The
exponential fading is assumed.
"""

from eha_core.compiled import inlined
from eha_core.decay import decayed
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="orifice",
    approximate=True,
    statement="the valve's lands are worn: about null each passes {conductance}, fading within {width}",
    equation="Q_port += conductance exp(-|x_v| / width) (P_s + P_r - 2 P_port)",
    parameters=(
        Parameter(
            name="conductance",
            symbol="G_0",
            unit="m^3/(s Pa)",
            nominal=0.0,
            lower=0.0,
            upper=1e-8,
            meaning="laminar conductance of each land at null",
            source=ASSUMED,
            typical=1e-12,
            switches=True,
            starts=(0.3, 3.0),
        ),
        Parameter(
            name="width",
            symbol="x_w",
            unit="A",
            nominal=2e-4,
            lower=1e-7,
            upper=1.0,
            meaning="spool position over which the leakage falls to 1/e",
            source=ASSUMED,
            typical=2e-4,
            logarithmic=True,
            relative_to="spool",
            starts=(0.3,),
        ),
    ),
    order=3,
)


@inlined
def contribution(opening, gain, conductance, spool_position, null_conductance, width):
    """Add the lands' conductance."""
    return opening, gain, conductance + null_conductance * decayed(abs(spool_position) / width)
