"""Dead time between the command and the coil: a sampled controller, a bus, a slow drive.

Signature: the motion follows the command unchanged in shape but late by the same time at every frequency.
Equation: the coil is driven by V(t - delay).
Sign: positive is late.
Validity: a constant delay, up to 0.2 s; between two steps the command is the mean of what was held. Sensors that are
all stamped as late, or a clock of theirs that is behind the command's, look the same: no recording tells the two apart.
Source: K. J. Astrom, R. M. Murray, Feedback Systems, Princeton University Press 2008, chapter 3 (time delays).
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="command",
    statement="the valve acts late, or all sensors are stamped late alike: {delay:4} pass between the command and what "
    "answers to it",
    equation="L_c I' = V(t - delay) - R_c I",
    parameters=(
        Parameter(
            name="delay",
            symbol="T_d",
            unit="s",
            nominal=0.0,
            lower=0.0,
            upper=0.2,
            meaning="time from command to coil",
            source=ASSUMED,
            typical=5e-3,
            switches=True,
            starts=(1.0, 3.0),
        ),
    ),
)


@inlined
def contribution(voltage, history, newest, step_size, delay):
    """Read the command back in the ring of past voltages, its last element not counted."""
    ring = history.shape[0] - 1
    steps = delay / step_size
    whole = int(steps)
    later = newest - whole
    if later < 0:
        later += ring
    earlier = later - 1 if later > 0 else ring - 1
    share = steps - whole
    return (1.0 - share) * history[later] + share * history[earlier]
