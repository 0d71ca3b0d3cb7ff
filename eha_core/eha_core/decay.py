"""exp(-x) as the compiled step takes it: by arithmetic alone, so that the compiler takes all lanes at once.

The C library's function is called lane by lane, which takes as long as a third of a whole step for every effect that
calls it.
"""

from __future__ import annotations

from eha_core.compiled import inlined

FARTHEST = 40.0
"""Beyond it exp(-x) counts as exp(-40) = 4e-18, which vanishes beside one."""


@inlined
def decayed(x):
    """exp(-x) of x >= 0, to 4e-16.

    Of x / 256 the Taylor series gives what is lost, w = 1 - exp(-x / 256); from exp(-2 z) = exp(-z)^2 follows that
    twice as far w (2 - w) is lost, which keeps a small w's relative precision.
    """
    z = min(x, FARTHEST) * 0.00390625
    lost = 1.0 / 720.0 - z * (1.0 / 5040.0)
    lost = 0.5 - z * (1.0 / 6.0 - z * (1.0 / 24.0 - z * (1.0 / 120.0 - z * lost)))
    lost = z - z * z * lost
    lost *= 2.0 - lost
    lost *= 2.0 - lost
    lost *= 2.0 - lost
    lost *= 2.0 - lost
    lost *= 2.0 - lost
    lost *= 2.0 - lost
    lost *= 2.0 - lost
    lost *= 2.0 - lost
    return 1.0 - lost
