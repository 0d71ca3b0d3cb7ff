"""A flow between the chambers that no effect of the catalogue explains, as a curve over their pressure difference.

Signature: whatever the recording showed; the curve was recovered from it and holds over the range that it covered.
Equation: q12 = K_Lin (P1 - P2) + curve(P1 - P2).
Sign: positive values flow from chamber A to chamber B.
Validity: inside the range of the recording; beyond it the curve's end values go on.
Source: recovered from a recording by `eha diagnose`.
"""

from eha_core.compiled import called
from eha_core.curve import curve_value, knot_parameters
from eha_core.effects.declaration import Effect

EFFECT = Effect(
    site="chamber",
    statement="oil flows between the chambers in a way that no effect of the catalogue explains",
    equation="q12 = ... + curve(P1 - P2)",
    parameters=knot_parameters("q", "m^3/s", 1.0, "flow from A to B"),
    named=False,
)


# many knots come as one tuple, which cannot be inlined
@called
def contribution(
    area_b,
    bulk_a,
    bulk_change_a,
    bulk_b,
    bulk_change_b,
    cross_flow,
    cross_slope,
    leakage_a,
    leakage_b,
    position,
    pressure_a,
    pressure_b,
    atmospheric_pressure,
    lower,
    upper,
    *knots,
):
    """Add the curve to the flow between the chambers."""
    value, slope = curve_value(pressure_a - pressure_b, lower, upper, knots)
    return (
        area_b,
        bulk_a,
        bulk_change_a,
        bulk_b,
        bulk_change_b,
        cross_flow + value,
        cross_slope + max(0.0, slope),
        leakage_a,
        leakage_b,
    )
