"""Hysteresis of the torque motor and the spool: the spool follows the current only past a play.

Signature: the piston's speed against the command is a loop, whose width does not shrink at low frequency.
Equation: target = I - half_width while the current rises, I + half_width while it falls, held in between.
Sign: positive half width lags behind the current.
Validity: hysteresis of constant width (a play); no minor loops of other shape.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 7 (servo valve hysteresis); M. A. Krasnosel'skii,
A. V. Pokrovskii, Systems with Hysteresis, Springer 1989 (the play operator).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="spool",
    approximate=True,
    statement="the spool follows the current only past a play of {half_width} to either side",
    equation="target = min(I + half_width, max(I - half_width, target before))",
    parameters=(
        Parameter(
            name="half_width",
            symbol="h_s",
            unit="A",
            nominal=0.0,
            lower=0.0,
            upper=0.02,
            meaning="half the width of the loop, in current",
            source=ASSUMED,
            typical=2e-4,
            switches=True,
            relative_to="spool",
            starts=(0.05, 0.2),
        ),
    ),
    memory=("current",),
)


@inlined
def contribution(target, memory, slot, half_width):
    """Move the play with the current."""
    memory[slot] = min(target + half_width, max(target - half_width, memory[slot]))
    return memory[slot]
