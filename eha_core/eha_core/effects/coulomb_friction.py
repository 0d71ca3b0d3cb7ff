"""Dry friction of seals and guides: a constant force against motion that holds the piston until it is overcome.

Signature: the pressure difference jumps at each reversal of the piston; the piston rests near the turning points.
Equation: M_p x_p'' = A_p (P1 - P2) - ... - force sign(v); at rest any force up to `force` is balanced.
Sign: a positive force opposes motion.
Validity: speeds above the Stribeck region; break-away no higher than sliding friction.
Source: H. Olsson, K. J. Astrom, C. Canudas de Wit, M. Gafvert, P. Lischinsky, "Friction models and friction
compensation", European Journal of Control 4 (1998).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import Effect
from eha_core.effects.friction_rows import sliding_force

EFFECT = Effect(
    site="force",
    kind="dry friction",
    approximate=True,
    statement="the seals rub: {force:4} of dry friction opposes motion and holds the piston at rest",
    equation="M_p x_p'' = ... - force sign(x_p')",
    parameters=(sliding_force("dry friction force"),),
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
    friction_force,
):
    """Add to the dry friction of the piston."""
    return force, damping, stiffness, dry_friction + friction_force
