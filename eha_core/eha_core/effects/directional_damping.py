"""Viscous friction of another height for each direction: a lip seal, or a spindle nut that is loaded on one flank.

Signature: at a steady speed one direction takes more force, and the difference grows with the speed; at rest and in
slow motion there is none.
Equation: F_v = B_s (1 + ratio sign(v)) v in place of B_s v.
Sign: a positive ratio brakes extension more, and retraction as much less.
Validity: laminar films; -1 <= ratio <= 1, so that neither direction is driven by its friction.
Source: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, "A survey of models, analysis tools and compensation
methods for the control of machines with friction", Automatica 30 (1994), section 2 (asymmetries).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="force",
    statement="viscous friction differs by direction: {ratio:+%} of its mean while extending, and as much the other "
    "way while retracting",
    equation="M_p x_p'' = ... - B_s (1 + ratio sign(x_p')) x_p'",
    parameters=(
        Parameter(
            name="ratio",
            symbol="r_B",
            unit="-",
            nominal=0.0,
            lower=-1.0,
            upper=1.0,
            meaning="half the difference between the directions, over the mean",
            source=ASSUMED,
            typical=0.3,
            switches=True,
            starts=(-0.3, 0.3),
        ),
    ),
    # it scales B_s, before other effects add damping of their own
    order=-1,
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
    ratio,
):
    """Scale the damping by the direction of the motion."""
    if velocity > 0.0:
        return force, damping * (1.0 + ratio), stiffness, dry_friction
    if velocity < 0.0:
        return force, damping * (1.0 - ratio), stiffness, dry_friction
    return force, damping, stiffness, dry_friction
