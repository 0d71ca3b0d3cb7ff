"""Friction of bristles that bend before they slide: a spring for micrometres, dry friction for millimetres (LuGre).

Signature: about each reversal the force turns over gradually with the displacement, and small loads move the piston a
little and let it spring back.
Equation: z' = v - stiffness |v| z / g(v), F_f = stiffness z + damping z',
g(v) = force + (static_force - force) exp(-(v / stribeck_velocity)^2).
Sign: positive z is a bristle bent along positive position; its force opposes.
Validity: one bristle for the whole seal; no memory of earlier reversals beyond its state.
Source: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, "A new model for control of systems with friction",
IEEE Transactions on Automatic Control 40 (1995).
"""

from eha_core.compiled import inlined
from eha_core.decay import decayed
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.effects.friction_rows import STRIBECK_VELOCITY, break_away_force, sliding_force
from eha_core.parameter import Parameter

LEAST_FORCE = 1e-6
"""N; keeps the bristle's bend finite where the friction vanishes."""

EFFECT = Effect(
    site="force",
    kind="dry friction",
    approximate=True,
    statement="the seals cling before they slide: {force:4} of friction ({static_force:4} to break away) "
    "behind a spring of {stiffness}",
    equation="F_f = stiffness z + damping z', z' = x_p' - stiffness |x_p'| z / g(x_p')",
    parameters=(
        sliding_force("friction in motion"),
        break_away_force("friction at break-away", typical=300.0),
        STRIBECK_VELOCITY,
        Parameter(
            name="stiffness",
            symbol="sigma_0",
            unit="N/m",
            nominal=5e6,
            lower=1e3,
            upper=1e9,
            meaning="stiffness of the bristles",
            source=ASSUMED,
            typical=5e6,
            logarithmic=True,
            starts=(0.2, 5.0),
        ),
        Parameter(
            name="damping",
            symbol="sigma_1",
            unit="N s/m",
            nominal=1e3,
            lower=0.0,
            upper=1e6,
            meaning="damping of the bristles",
            source=ASSUMED,
            typical=1e3,
        ),
    ),
    memory=("zero",),
)


@inlined
def level_of(velocity, sliding, static, stribeck_velocity):
    """g(v) in N, and its fall over the speed times that speed, as a share of it: -|v| g'(v) / g(v)."""
    square = (velocity / stribeck_velocity) ** 2
    excess = (static - sliding) * decayed(square)
    level = max(LEAST_FORCE, sliding + excess)
    return level, 2.0 * square * excess / level


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
    bristle_stiffness,
    bristle_damping,
):
    """Bend with the motion since the last step, then offer force, damping and stiffness of the bend to come.

    The bend keeps to its equation to second order in the step, and exactly where it has settled. Its force is taken
    ahead, with the speed to come, by the share of a step in which it settles: so it is stable where it settles at once.
    The bend's rate there is linearised about the present speed, `gain` v - `loss` z, so that friction that falls over
    the speed is of second order, too; the damping of that rate goes where the bend settles at once.
    """
    level, fall = level_of(velocity, sliding, static, stribeck_velocity)
    slip = bristle_stiffness * abs(velocity) / level
    settled = step_size * slip
    bend = memory[slot] + step_size * (1.0 + 0.5 * settled) * velocity
    bend /= 1.0 + settled + 0.5 * settled * settled
    memory[slot] = bend
    held = 1.0 / (1.0 + settled)
    ahead = step_size * held * held * settled
    towards = 1.0 if velocity > 0.0 else -1.0 if velocity < 0.0 else 0.0
    gain = 1.0 - (1.0 + fall) * bristle_stiffness * bend * towards / level
    loss = -fall * slip
    resisting = bristle_damping / (1.0 + 0.25 * settled * settled)
    force -= (bristle_stiffness * (1.0 - loss * ahead) - resisting * loss) * bend
    damping += gain * (bristle_stiffness * ahead + resisting)
    return force, damping, stiffness + bristle_stiffness * held * held, dry_friction
