"""Flow that no longer follows the spool: at large openings another restriction in the line takes the pressure.

Signature: fast strokes stay behind the command, both ways alike and at once; small strokes are as before. A weak
supply does so only after its lag, and shows in the supply's pressure.
Equation: x_v / (1 + curvature |x_v|) opens the ports in place of x_v.
Sign: a positive curvature lowers the flow.
Validity: a restriction in series that is fixed, such as a manifold's bore; no cavitation.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 5 (flow gain near saturation).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="orifice",
    approximate=True,
    statement="the valve's flow saturates: each further opening brings less, by {curvature}",
    equation="x_v -> x_v / (1 + curvature |x_v|)",
    parameters=(
        Parameter(
            name="curvature",
            symbol="c_v",
            unit="1/A",
            nominal=0.0,
            lower=0.0,
            upper=1e6,
            meaning="inverse of the opening at which the flow is halved",
            source=ASSUMED,
            typical=500.0,
            switches=True,
            starts=(0.3, 2.0),
        ),
    ),
    # what the spool has opened, overlap and offset included, is what saturates
    order=3,
)


@inlined
def contribution(opening, gain, conductance, spool_position, curvature):
    """Bend the opening."""
    return opening / (1.0 + curvature * abs(opening)), gain, conductance
