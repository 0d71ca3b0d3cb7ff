"""Supply pressure that falls when oil is drawn: a pump and line of finite stiffness.

Signature: fast strokes fall short, and more so while they last; both chambers' pressures sag together.
Equation: time_constant l' + l = resistance Q_s; the valve sees P_s - l, |l| no more than P_s - P_r.
Sign: positive resistance lowers the pressure while oil is drawn.
Validity: small departures about one working point; no line resonance.
Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapter 11 (supplies and their droop). First order is
assumed.
"""

from eha_core.compiled import inlined
from eha_core.decay import decayed
from eha_core.effects.declaration import ASSUMED, Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="supply",
    statement="the supply gives way: its pressure falls by {resistance} drawn, within {time_constant}",
    equation="P_s -> P_s - l, time_constant l' + l = resistance Q_s",
    parameters=(
        Parameter(
            name="resistance",
            symbol="R_s",
            unit="Pa s/m^3",
            nominal=0.0,
            lower=0.0,
            upper=1e13,
            meaning="pressure lost per flow drawn",
            source=ASSUMED,
            typical=3e10,
            switches=True,
            relative_to="supply_flow",
            starts=(0.05, 0.2),
        ),
        Parameter(
            name="time_constant",
            symbol="T_s",
            unit="s",
            nominal=0.1,
            lower=1e-3,
            upper=100.0,
            meaning="time constant of the supply pressure",
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
    """Let the loss follow the flow, which is held over the step."""
    loss = resistance * supply_flow
    loss += (memory[slot] - loss) * decayed(step_size / time_constant)
    span = supply_pressure - return_pressure
    memory[slot] = min(span, max(-span, loss))
    return supply_pressure - memory[slot], return_pressure
