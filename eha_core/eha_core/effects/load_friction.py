"""Dry friction of a seal that the oil presses against the bore: it grows with the pressure across the piston.

Signature: at a reversal the pressure difference jumps by a share of itself; under little load the piston moves freely.
Where the load is viscous alone it is more viscous friction, and is not seen.
Equation: M_p x_p'' = ... - coefficient |P1 - P2| sign(v); at rest any force up to that height is balanced.
Sign: a positive coefficient opposes motion.
Validity: friction in proportion to the contact force (Coulomb); elastic seals follow a power of it, near 2/3.
Source: G. K. Nikas, "Eighty years of research on hydraulic reciprocating seals", Proceedings of the Institution of
Mechanical Engineers J 224 (2010).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="force",
    kind="dry friction",
    approximate=True,
    statement="the seals rub the more the oil presses them: dry friction is {coefficient} times the pressure across "
    "the piston",
    equation="M_p x_p'' = ... - coefficient |P1 - P2| sign(x_p')",
    parameters=(
        Parameter(
            name="coefficient",
            symbol="C_P",
            unit="m^2",
            nominal=0.0,
            lower=0.0,
            upper=1e-2,
            meaning="dry friction for each pascal across the piston",
            source=ASSUMED,
            typical=1e-4,
            switches=True,
            starts=(0.5, 2.0),
        ),
    ),
    # given force alone, nobody knows what the pressures were
    needs=("measured_pressure_a",),
)


@inlined
def contribution(
    force,
    damping,
    stiffness,
    dry_friction,
    position,
    velocity,
    pressure_a,
    pressure_b,
    memory,
    slot,
    step_size,
    coefficient,
):
    """Add to the dry friction of the piston."""
    return force, damping, stiffness, dry_friction + coefficient * abs(pressure_a - pressure_b)
