"""A steady force on the piston: gravity, a counterweight, a tool that pushes.

Signature: the mean pressure difference is not zero; the piston gives way to one side where oil leaks.
Equation: - force.
Sign: a positive load pushes back against extension.
Validity: constant in time and place.
Source: the load force of H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 6.
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="force",
    statement="a steady load of {force:4} pushes against extension",
    opposite="a steady load of {force:4} pushes towards extension",
    equation="M_p x_p'' = ... - force",
    parameters=(
        Parameter(
            name="force",
            symbol="F_L",
            unit="N",
            nominal=0.0,
            lower=-1e6,
            upper=1e6,
            meaning="load against extension",
            source=ASSUMED,
            typical=500.0,
            switches=True,
            relative_to="force",
            starts=(-0.3, 0.3),
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
    load,
):
    """Take the load off the force."""
    return force - load, damping, stiffness, dry_friction
