"""Play between the piston and its position sensor: a loose coupling, a worn pick-off.

Signature: the measured position rests after each reversal while the pressures show that the piston moves.
Equation: y = x_p - half_width while the piston extends, x_p + half_width while it retracts, held in between.
Sign: positive half width holds the measured position back.
Validity: a pick-off without inertia that is held by friction within the play.
Source: M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis, Springer 1989 (the play operator).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="sensor",
    statement="the position sensor has a play of {half_width} to either side",
    equation="y = min(x_p + half_width, max(x_p - half_width, y before))",
    parameters=(
        Parameter(
            name="half_width",
            symbol="h_y",
            unit="m",
            nominal=0.0,
            lower=0.0,
            upper=0.1,
            meaning="half the play",
            source=ASSUMED,
            typical=2e-4,
            switches=True,
            starts=(0.5, 1.5),
        ),
    ),
    memory=("position",),
    order=0,
)


@inlined
def contribution(position, velocity, pressure_a, pressure_b, memory, slot, step_size, half_width):
    """Drag the pick-off along; it has the piston's speed or none."""
    before = memory[slot]
    seen = min(position + half_width, max(position - half_width, before))
    memory[slot] = seen
    return seen, (velocity if seen != before else 0.0), pressure_a, pressure_b
