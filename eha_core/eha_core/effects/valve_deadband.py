"""Overlap of the spool's lands: the ports stay shut until the spool has moved past the overlap.

Signature: the piston rests while the command moves about null, and follows a little late after each change of
direction; with a controller in the loop, a slow limit cycle about the target.
Equation: opening = e(x_v - d) - e(-x_v - d) with d the half width; past an edge e(y) = y, before it 0, and within the
rounding r of it e(y) = (y + r)^2 / (4 r).
Sign: positive half width is overlap; it narrows the opening on both sides alike.
Validity: overlap small against the spool's travel. Worn edges are a parabola that joins both sides smoothly; what leaks
from the supply to the return where both ports stand open is valve_null_leakage.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 5 (overlapped spool valves; rounded edges and the
flow gain about null); the parabola is assumed.
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="orifice",
    approximate=True,
    statement="the valve's lands overlap: within {half_width} of null no oil flows",
    equation="opening = sign(x_v) max(|x_v| - half_width, 0), edges rounded within +-rounding",
    parameters=(
        Parameter(
            name="half_width",
            symbol="x_d",
            unit="A",
            nominal=0.0,
            lower=0.0,
            upper=0.02,
            meaning="half the width of the overlap, in spool position",
            source=ASSUMED,
            typical=2e-4,
            switches=True,
            relative_to="spool",
            starts=(0.05, 0.2),
        ),
        Parameter(
            name="rounding",
            symbol="x_r",
            unit="A",
            nominal=0.0,
            lower=0.0,
            upper=0.02,
            meaning="how far about its edge a worn land opens gradually, in spool position",
            source=ASSUMED,
            typical=5e-5,
            relative_to="spool",
            starts=(0.02,),
        ),
    ),
    order=1,
)


@inlined
def past_edge(overlap, rounding):
    """How far a land stands open whose edge the spool has passed by `overlap`."""
    if overlap >= rounding:
        return overlap
    if overlap <= -rounding:
        return 0.0
    return (overlap + rounding) * (overlap + rounding) / (4.0 * rounding)


@inlined
def contribution(opening, gain, conductance, spool_position, half_width, rounding):
    """Shut the ports inside the overlap and shift the opening outside of it."""
    opening = past_edge(opening - half_width, rounding) - past_edge(-opening - half_width, rounding)
    return opening, gain, conductance
