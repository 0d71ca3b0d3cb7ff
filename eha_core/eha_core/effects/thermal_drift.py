"""Oil that warms up: viscous damping falls and leakage rises, and both settle.

Signature: speed under load and pressure difference change slowly over the recording, in one direction, and level out.
Equation: with w = 1 - exp(-t / time_constant): B_s -> B_s (1 - damping_ratio w), K_Lin -> K_Lin (1 + leakage_ratio w).
Sign: positive ratios are those of warming oil.
Validity: one thermal mass; viscosity linear in temperature over the range.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 2 (viscosity and temperature). First order is
assumed.
"""

from eha_core.compiled import inlined
from eha_core.decay import decayed
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="schedule",
    approximate=True,
    statement="the oil warms up within {time_constant}: damping falls by {damping_ratio:%}, "
    "internal leakage rises by {leakage_ratio:%}",
    equation="B_s -> B_s (1 - damping_ratio w), K_Lin -> K_Lin (1 + leakage_ratio w), w = 1 - exp(-t / time_constant)",
    parameters=(
        Parameter(
            name="damping_ratio",
            symbol="d_B",
            unit="-",
            nominal=0.0,
            lower=0.0,
            upper=1.0,
            meaning="share of the damping that is lost in the end",
            source=ASSUMED,
            typical=0.4,
            switches=True,
            starts=(1.0, 0.0),
        ),
        Parameter(
            name="leakage_ratio",
            symbol="d_K",
            unit="-",
            nominal=0.0,
            lower=0.0,
            upper=1e5,
            meaning="rise of the leakage in the end, over its start",
            source=ASSUMED,
            typical=20.0,
            switches=True,
            starts=(1.0, 0.0),
        ),
        Parameter(
            name="time_constant",
            symbol="T_w",
            unit="s",
            nominal=3.0,
            lower=1e-2,
            upper=1e5,
            meaning="time constant of the warming",
            source=ASSUMED,
            typical=3.0,
            logarithmic=True,
            relative_to="time",
            starts=(0.3,),
        ),
    ),
    order=1,
)


@inlined
def contribution(internal_leakage, damping, time, damping_ratio, leakage_ratio, time_constant):
    """Apply what of the warming has come about."""
    warmth = 1.0 - decayed(time / time_constant)
    return internal_leakage * (1.0 + leakage_ratio * warmth), damping * (1.0 - damping_ratio * warmth)
