"""A valve whose ports open otherwise than in proportion to the spool, as a curve over the spool's position.

Signature: whatever the recording showed; the curve was recovered from it and holds over the range that it covered.
Equation: opening = x_v + curve(x_v).
Sign: positive values open port A to the supply.
Validity: inside the range of the recording; beyond it the curve's end values go on.
Source: recovered from a recording by `eha diagnose`.
"""

from eha_core.compiled import called
from eha_core.curve import curve_value, knot_parameters
from eha_core.effects.declaration import Effect

EFFECT = Effect(
    site="orifice",
    statement="the valve's ports open otherwise than in proportion to the spool",
    equation="opening = x_v + curve(x_v)",
    parameters=knot_parameters("o", "A", 1.0, "opening beyond the spool's position"),
    order=4,
    named=False,
)


# many knots come as one tuple, which cannot be inlined
@called
def contribution(opening, gain, conductance, spool_position, lower, upper, *knots):
    """Add the curve to the opening."""
    value, _ = curve_value(spool_position, lower, upper, knots)
    return opening + value, gain, conductance
