"""A valve whose flow gain differs between the two directions.

Signature: the piston retracts slower (or faster) than it extends under commands of equal size; a symmetric command
drifts.
Equation: gain = K for opening >= 0, K (1 - ratio) for opening < 0.
Sign: a positive ratio weakens the flow towards retraction.
Validity: lands of different width or wear on the two sides, each linear.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapters 5 and 7 (flow gain and its symmetry).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="orifice",
    statement="the valve's flow gain towards retraction is {ratio:%} lower than towards extension",
    opposite="the valve's flow gain towards retraction is {ratio:%} higher than towards extension",
    equation="K -> K (1 - ratio) for x_v < 0",
    parameters=(
        Parameter(
            name="ratio",
            symbol="r_K",
            unit="-",
            nominal=0.0,
            lower=-1.0,
            upper=0.9,
            meaning="share of the flow gain that is missing towards retraction",
            source=ASSUMED,
            typical=0.15,
            switches=True,
            starts=(-1.0, 1.0),
        ),
    ),
    order=2,
)


@inlined
def contribution(opening, gain, conductance, spool_position, ratio):
    """Weaken the gain on one side."""
    if opening < 0.0:
        gain *= 1.0 - ratio
    return opening, gain, conductance
