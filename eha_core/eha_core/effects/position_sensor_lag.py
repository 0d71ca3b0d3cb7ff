"""A position sensor or its filter that follows late.

Signature: the measured position trails the pressures' account of the motion, more so the faster it is.
Equation: time_constant y' + y = x_p; y is measured, y' is the measured velocity.
Sign: positive is late.
Validity: first-order filter; the velocity is derived from the same signal.
Source: E. O. Doebelin, Measurement Systems, McGraw-Hill 1966, chapter 3 (first-order instruments).
"""

from eha_core.compiled import inlined
from eha_core.decay import decayed
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="sensor",
    statement="the position sensor lags: it follows with a time constant of {time_constant:4}",
    equation="time_constant y' + y = x_p",
    parameters=(
        Parameter(
            name="time_constant",
            symbol="T_y",
            unit="s",
            nominal=0.0,
            lower=0.0,
            upper=10.0,
            meaning="time constant of the sensor",
            source=ASSUMED,
            typical=5e-3,
            switches=True,
            starts=(1.0, 3.0),
        ),
    ),
    memory=("position",),
    order=1,
)


@inlined
def contribution(position, velocity, pressure_a, pressure_b, memory, slot, step_size, time_constant):
    """Follow exactly a position that has moved steadily over the step."""
    trailing = velocity * time_constant
    start = position - velocity * step_size
    seen = position - trailing + (memory[slot] - start + trailing) * decayed(step_size / time_constant)
    memory[slot] = seen
    return seen, (position - seen) / time_constant, pressure_a, pressure_b
