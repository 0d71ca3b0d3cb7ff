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
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="force",
    kind="dry friction",
    approximate=True,
    statement="the seals rub and stick: {static_force:4} to break away, {force:4} in motion past {stribeck_velocity}",
    equation="M_p x_p'' = ... - (force + (static_force - force) exp(-|x_p' / stribeck_velocity|^shape)) sign(x_p')",
    parameters=(
        Parameter(
            "force",
            "F_c",
            "N",
            0.0,
            0.0,
            1e5,
            "dry friction in motion",
            ASSUMED,
            typical=200.0,
            switches=True,
            relative_to="force",
            starts=(0.1, 0.4),
        ),
        Parameter(
            "static_force",
            "F_s",
            "N",
            0.0,
            0.0,
            1e5,
            "dry friction at rest",
            ASSUMED,
            typical=350.0,
            switches=True,
            relative_to="force",
            starts=(0.2, 0.6),
            above="force",
        ),
        Parameter(
            "stribeck_velocity",
            "v_s",
            "m/s",
            0.01,
            1e-5,
            10.0,
            "speed over which friction falls",
            ASSUMED,
            typical=0.01,
            logarithmic=True,
            relative_to="speed",
            starts=(0.2,),
        ),
        Parameter(
            "shape",
            "delta",
            "-",
            2.0,
            0.5,
            4.0,
            "how the fall begins: 1 at once, 2 and more rounded",
            "Armstrong-Helouvry, Dupont, Canudas de Wit 1994",
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
