"""A load that stiffens as it is displaced: rubber, leaf springs, a specimen.

Signature: the pressure difference grows faster than in proportion towards both ends of the motion.
Equation: - coefficient x_p^3.
Sign: a positive coefficient pushes back to the middle.
Validity: a symmetric spring whose middle is the stroke's middle.
Source: S. H. Strogatz, Nonlinear Dynamics and Chaos, Perseus 1994, chapter 7 (the hardening Duffing spring).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="force",
    statement="the load is a spring that hardens: {coefficient:4} times its displacement cubed",
    equation="M_p x_p'' = ... - coefficient x_p^3",
    parameters=(
        Parameter(
            name="coefficient",
            symbol="k_3",
            unit="N/m^3",
            nominal=0.0,
            lower=0.0,
            upper=1e12,
            meaning="force per cube of the displacement",
            source=ASSUMED,
            typical=1e8,
            switches=True,
            starts=(0.1, 1.0),
        ),
    ),
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
    """Push back, and say how stiffly."""
    square = coefficient * position * position
    return force - square * position, damping, stiffness + 3.0 * square, dry_friction
