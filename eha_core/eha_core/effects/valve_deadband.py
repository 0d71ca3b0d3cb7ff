"""Overlap of the spool's lands: the ports stay shut until the spool has moved past the overlap.

Signature: the piston rests while the command moves about null, and follows a little late after each change of
direction; with a controller in the loop, a slow limit cycle about the target.
Equation: opening = x_v - d for x_v > d, 0 for |x_v| <= d, x_v + d for x_v < -d, with d the half width.
Sign: positive half width is overlap; it narrows the opening on both sides alike.
Validity: overlap small against the spool's travel; lands without rounding.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 5 (overlapped spool valves).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="orifice",
    approximate=True,
    statement="the valve's lands overlap: within {half_width:.3g} A of null no oil flows",
    equation="opening = sign(x_v) max(|x_v| - half_width, 0)",
    parameters=(
        Parameter(
            "half_width",
            "x_d",
            "A",
            0.0,
            0.0,
            0.02,
            "half the width of the overlap, in spool position",
            ASSUMED,
            typical=2e-4,
            switches=True,
            relative_to="spool",
            starts=(0.05, 0.2),
        ),
    ),
    order=1,
)


@inlined
def contribution(opening, gain, conductance, spool_position, half_width):
    """Shut the ports inside the overlap and shift the opening outside of it."""
    if opening > half_width:
        opening -= half_width
    elif opening < -half_width:
        opening += half_width
    else:
        opening = 0.0
    return opening, gain, conductance
