"""Return pressure that rises when oil flows back: a long or narrow return line, a clogged filter.

Signature: fast strokes fall short, and both chambers' pressures rise together while they last.
Equation: time_constant b' + b = resistance Q_r; the valve sees P_r + b, |b| no more than P_s - P_r.
Sign: positive resistance raises the pressure while oil returns.
Validity: small departures about one working point; no line resonance.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 3 (flow through lines). First order is assumed.
"""

from eha_core.compiled import inlined
from eha_core.decay import decayed
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="supply",
    statement="the return line resists: its pressure rises by {resistance} returned, within {time_constant}",
    equation="P_r -> P_r + b, time_constant b' + b = resistance Q_r",
    parameters=(
        Parameter(
            name="resistance",
            symbol="R_r",
            unit="Pa s/m^3",
            nominal=0.0,
            lower=0.0,
            upper=1e13,
            meaning="pressure gained per flow returned",
            source=ASSUMED,
            typical=3e10,
            switches=True,
            relative_to="supply_flow",
            starts=(0.05, 0.2),
        ),
        Parameter(
            name="time_constant",
            symbol="T_r",
            unit="s",
            nominal=0.1,
            lower=1e-3,
            upper=100.0,
            meaning="time constant of the return pressure",
            source=ASSUMED,
            typical=0.1,
            logarithmic=True,
            starts=(0.5, 2.0),
        ),
    ),
    memory=("zero",),
)


@inlined
def contribution(
    supply_pressure,
    return_pressure,
    supply_flow,
    return_flow,
    memory,
    slot,
    step_size,
    resistance,
    time_constant,
):
    """Let the rise follow the flow, which is held over the step."""
    rise = resistance * return_flow
    rise += (memory[slot] - rise) * decayed(step_size / time_constant)
    span = supply_pressure - return_pressure
    memory[slot] = min(span, max(-span, rise))
    return supply_pressure, return_pressure + memory[slot]
