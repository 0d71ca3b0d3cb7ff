"""Dry friction that is higher at rest than in motion: break-away, then less resistance as a film of oil builds up.

Signature: slow motion goes in jumps (stick-slip); the pressure difference peaks at the start of each motion.
Equation: - (force + (static_force - force) exp(-|v / stribeck_velocity|^shape)) sign(v); at rest up to static_force
is balanced. A shape of 2 is a Gaussian, 1 is Tustin's exponential; seals and guides show 0.5 to 2 and more.
Sign: positive forces oppose motion.
Validity: friction that follows the speed at once; no presliding displacement.
Source: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, "A survey of models, analysis tools and compensation
methods for the control of machines with friction", Automatica 30 (1994).
"""

from eha_core.compiled import inlined
from eha_core.decay import decayed
from eha_core.effects.declaration import Effect
from eha_core.effects.friction_rows import STRIBECK_VELOCITY, break_away_force, sliding_force
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="force",
    kind="dry friction",
    approximate=True,
    statement="the seals rub and stick: {static_force:4} to break away, {force:4} in motion past {stribeck_velocity}",
    equation="M_p x_p'' = ... - (force + (static_force - force) exp(-|x_p' / stribeck_velocity|^shape)) sign(x_p')",
    parameters=(
        sliding_force("dry friction in motion"),
        break_away_force("dry friction at rest", typical=350.0),
        STRIBECK_VELOCITY,
        Parameter(
            name="shape",
            symbol="delta",
            unit="-",
            nominal=2.0,
            lower=0.5,
            upper=4.0,
            meaning="how the fall begins: 1 at once, 2 and more rounded",
            source="Armstrong-Helouvry, Dupont, Canudas de Wit 1994",
            typical=2.0,
            logarithmic=True,
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
    sliding,
    static,
    stribeck_velocity,
    shape,
):
    """Linearise about the present speed: the fall of the friction there is a damping below zero."""
    share = abs(velocity) / stribeck_velocity
    power = share**shape
    excess = (static - sliding) * decayed(power)
    fall = shape * power * excess
    # a shape below 1 falls infinitely fast at rest: no faster than over the Stribeck velocity
    slope = fall / (stribeck_velocity * max(share, min(power, 1.0))) if power > 0.0 else 0.0
    return force, damping - slope, stiffness, dry_friction + sliding + excess + slope * abs(velocity)
