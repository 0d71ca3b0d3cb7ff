"""Resistance that grows with the square of the speed: oil forced through ports, a load that moves in a fluid.

Signature: fast strokes need more pressure difference than viscous damping explains; slow ones are as before.
Equation: - coefficient v |v|.
Sign: a positive coefficient opposes motion.
Validity: turbulent flow; a coefficient that does not depend on the direction.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 3 (turbulent losses).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="force",
    statement="fast motion is braked by {coefficient:4} times its speed squared",
    equation="M_p x_p'' = ... - coefficient x_p' |x_p'|",
    parameters=(
        Parameter(
            name="coefficient",
            symbol="B_q",
            unit="N s^2/m^2",
            nominal=0.0,
            lower=0.0,
            upper=1e8,
            meaning="force per square of the speed",
            source=ASSUMED,
            typical=2e4,
            switches=True,
            starts=(0.3, 3.0),
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
    """Linearise about the present speed: -c v |v| is c v_0 |v_0| - 2 c |v_0| v near v_0."""
    slope = coefficient * abs(velocity)
    return force + slope * velocity, damping + 2.0 * slope, stiffness, dry_friction
