"""Pressure sensors or their lines and filters that follow late, each its own.

Signature: a measured pressure trails the piston's motion and the other chamber's pressure, more so the faster it
changes; steady pressures are right.
Equation: time_constant_a y' + y = P1, y the measured P1; time_constant_b likewise of P2.
Sign: positive is late.
Validity: first-order filter. One whose order is higher, or a channel that is stamped late, has the same delay at the
frequencies of the motion. Pressures that are both late by T look like those of a load that is lighter by T times its
damping coefficient: a difference between the two chambers is identified sharply, what they share under a light
load is not.
Source: E. O. Doebelin, Measurement Systems, McGraw-Hill 1966, chapter 3 (first-order instruments).
"""

from eha_core.compiled import inlined
from eha_core.decay import decayed
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="sensor",
    statement="the pressures are measured late: chamber A's with a time constant of {time_constant_a:4}, chamber B's "
    "with {time_constant_b:4}",
    equation="time_constant_a y' + y = P1, y the measured P1; P2 with time_constant_b",
    parameters=(
        Parameter(
            name="time_constant_a",
            symbol="T_1",
            unit="s",
            nominal=0.0,
            lower=0.0,
            upper=10.0,
            meaning="time constant of chamber A's sensor",
            source=ASSUMED,
            typical=5e-3,
            switches=True,
            starts=(1.0, 0.0),
        ),
        Parameter(
            name="time_constant_b",
            symbol="T_2",
            unit="s",
            nominal=0.0,
            lower=0.0,
            upper=10.0,
            meaning="time constant of chamber B's sensor",
            source=ASSUMED,
            typical=3e-3,
            switches=True,
            starts=(1.0, 0.0),
        ),
    ),
    memory=("pressure_a", "pressure_b"),
    # last: what is remembered is then what is shown, gain and zero included, and can start from a recording
    order=4,
    needs=("measured_pressure_a",),
)


@inlined
def late(pressure, old, step_size, time_constant):
    """Follow exactly a pressure that has changed steadily over the step: what is shown, and what the next step needs.

    That holds the pressure and what was shown, in the proportion in which the next step takes them, as `old` does.
    """
    kept = decayed(step_size / time_constant)
    risen = (1.0 - kept) * (time_constant / step_size)
    shown = (1.0 - risen) * pressure + risen * old
    held = (kept * shown + (risen - kept) * pressure) / risen
    # without a lag nothing is held; asked last and of each, so that the compiler can choose in all lanes at once
    return (shown if time_constant > 0.0 else pressure), (held if time_constant > 0.0 else pressure)


@inlined
def contribution(
    position,
    velocity,
    pressure_a,
    pressure_b,
    memory,
    slot_a,
    slot_b,
    step_size,
    time_constant_a,
    time_constant_b,
):
    """Show both pressures late."""
    shown_a, memory[slot_a] = late(pressure_a, memory[slot_a], step_size, time_constant_a)
    shown_b, memory[slot_b] = late(pressure_b, memory[slot_b], step_size, time_constant_b)
    return position, velocity, shown_a, shown_b
