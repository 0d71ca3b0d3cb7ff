"""A seal that fails: the internal leakage jumps at one time and stays.

Signature: all is as the model says up to a moment; from then on the piston loses speed under load.
Equation: K_Lin -> internal_leakage for t >= time.
Sign: the coefficient in force after the jump, not what it adds.
Validity: a sudden failure, laminar before and after.
Source: the leakage levels of Table 2 of the model's paper, entered during one run.
"""

from eha_core.compiled import inlined
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="schedule",
    statement="the piston's seal fails at {time:4}: internal leakage jumps to {internal_leakage}",
    equation="K_Lin -> internal_leakage for t >= time",
    parameters=(
        Parameter(
            name="time",
            symbol="t_0",
            unit="s",
            nominal=0.0,
            lower=0.0,
            upper=1e6,
            meaning="when the leakage jumps",
            source=ASSUMED,
            typical=0.3,
            relative_to="time",
            starts=(0.2, 0.35, 0.5, 0.65, 0.8),
        ),
        Parameter(
            name="internal_leakage",
            symbol="K_1",
            unit="m^3/(s Pa)",
            nominal=0.0,
            lower=0.0,
            upper=1e-7,
            meaning="internal leakage from then on",
            source=ASSUMED,
            typical=1e-10,
            switches=True,
            relative_to="leakage_flow",
            replaces="internal_leakage",
            starts=(0.3,),
        ),
    ),
    order=0,
)


@inlined
def contribution(internal_leakage, damping, time, onset, leakage_after):
    """Swap the coefficient once the time has come."""
    if time >= onset:
        internal_leakage = leakage_after
    return internal_leakage, damping
