"""A force on the piston that no effect of the catalogue explains, as a curve over position, velocity, load or time.

Signature: whatever the recording showed; the curve was recovered from it and holds over the range that it covered.
Equation: M_p x_p'' = ... + curve(z), z the position, the velocity, the pressure difference or the time since the start;
or ... + curve(x_p) x_p'.
Sign: positive values push the piston along positive position.
Validity: inside the range of the recording; beyond it the curve's end values go on.
Source: recovered from a recording by `eha diagnose`.
"""

from eha_core.compiled import called
from eha_core.curve import SOURCE, curve_value, knot_parameters
from eha_core.effects.declaration import Effect
from eha_core.parameter import Parameter

EFFECT = Effect(
    site="force",
    statement="a force acts on the piston that no effect of the catalogue explains",
    equation="M_p x_p'' = ... + curve(z)",
    parameters=(
        Parameter(
            name="variable",
            symbol="z",
            unit="-",
            nominal=0.0,
            lower=0.0,
            upper=4.0,
            meaning="what the curve is over: 0 position, 1 velocity, 2 pressure difference, 3 time, 4 position, times "
            "velocity",
            source=SOURCE,
        ),
        *knot_parameters("F", "N", 1e7, "force"),
    ),
    memory=("zero",),
    named=False,
)


# many knots come as one tuple, which cannot be inlined
@called
def contribution(
    force,
    damping,
    stiffness,
    dry_friction,
    position,
    velocity,
    pressure_a,
    pressure_b,
    memory,
    slot,
    step_size,
    variable,
    lower,
    upper,
    *knots,
):
    """Add the curve's force; over velocity its slope is implicit where it damps."""
    memory[slot] += step_size
    if variable < 0.5:
        value, _ = curve_value(position, lower, upper, knots)
        return force + value, damping, stiffness, dry_friction
    if variable < 1.5:
        value, slope = curve_value(velocity, lower, upper, knots)
        drag = max(0.0, -slope)
        return force + value + drag * velocity, damping + drag, stiffness, dry_friction
    if variable > 3.5:
        value, _ = curve_value(position, lower, upper, knots)
        return force, damping - value, stiffness, dry_friction
    at = pressure_a - pressure_b if variable < 2.5 else memory[slot]
    value, _ = curve_value(at, lower, upper, knots)
    return force + value, damping, stiffness, dry_friction
