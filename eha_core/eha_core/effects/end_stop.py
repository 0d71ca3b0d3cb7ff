"""A cushion, bumper or obstacle inside the stroke: spring and damper past a position.

Signature: the piston slows and stalls at one position while the pressures go on rising; all else is as before.
Equation: past `upper`: - stiffness (x_p - upper) - damping x_p'; past `lower` alike, with lower for upper.
Sign: the spring pushes back towards the middle.
Validity: linear contact that does not pull; the damper acts during contact in both directions.
Source: K. H. Hunt, F. R. E. Crossley, "Coefficient of restitution interpreted as damping in vibroimpact", Journal of
Applied Mechanics 42 (1975), its linear (Kelvin-Voigt) case.
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="force",
    approximate=True,
    statement="the piston meets a stop: below {lower:4} or above {upper:4} a spring of {stiffness} pushes back",
    equation="M_p x_p'' = ... - stiffness (x_p - limit) - damping x_p' past a limit",
    parameters=(
        Parameter(
            name="lower",
            symbol="x_l",
            unit="m",
            nominal=-10.0,
            lower=-10.0,
            upper=10.0,
            meaning="position below which the lower stop acts",
            source=ASSUMED,
            typical=-0.02,
            relative_to="position",
            starts=(-0.8, -50.0),
        ),
        Parameter(
            name="upper",
            symbol="x_u",
            unit="m",
            nominal=10.0,
            lower=-10.0,
            upper=10.0,
            meaning="position above which the upper stop acts",
            source=ASSUMED,
            typical=0.02,
            relative_to="position",
            starts=(0.8, 50.0),
        ),
        Parameter(
            name="stiffness",
            symbol="k_e",
            unit="N/m",
            nominal=0.0,
            lower=0.0,
            upper=1e10,
            meaning="stiffness of the stop",
            source=ASSUMED,
            typical=1e6,
            switches=True,
        ),
        Parameter(
            name="damping",
            symbol="b_e",
            unit="N s/m",
            nominal=0.0,
            lower=0.0,
            upper=1e7,
            meaning="damping of the stop while it is touched",
            source=ASSUMED,
            typical=1e3,
            switches=True,
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
    lower,
    upper,
    stop_stiffness,
    stop_damping,
):
    """Push back while the piston is past a stop."""
    if lower <= position <= upper:
        return force, damping, stiffness, dry_friction
    push = stop_stiffness * (position - (upper if position > upper else lower))
    return force - push, damping + stop_damping, stiffness + stop_stiffness, dry_friction
