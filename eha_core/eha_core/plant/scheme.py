"""The pieces of one step, free of effects: the scalar step and the lock-step one put the same hooks between them.

They integrate `equations` (3) to (9) and the force of (10). Of (1), (2) and (10) they hold solutions over a step, which
have no term in common with the derivative; `tests/plant/test_derivatives.py` holds the two against each other.

One step is a Strang splitting. Coil and spool do not depend on the piston and go first, by exact propagators. Then half
a step of oil and position, a whole step of velocity, half a step of oil and position:

* oil: exponential Rosenbrock-Euler with the L-stable rational approximation of its function, so that ports held open at
  small pressure differences and strong leakage stay stable at any step;
* velocity: damping implicit, dry friction as a proximal step (it sticks exactly and is not stiff), and the mass
  enlarged by `theta h^2 k`, where k is the stiffness of oil, spring and stops. With theta = 1/12 the staggered scheme's
  frequency error falls from second to fourth order in h; theta rises to 1/4 for k h^2 / M large, where the scheme is
  then stable for any k;
* the stroke's ends: a piston that would pass one lands on it with what speed the rest of the step needs, and stops
  (an inelastic impact). Absolute pressures end at zero, where the oil would boil.
"""

from __future__ import annotations

from math import copysign

from eha_core.compiled import inlined
from eha_core.plant.equations import external_leakage_flow, net_flows, orifices, volumes


@inlined
def coil_current(current, voltage, decay, conductance, saturation):
    """Equation (1) over one step under a held voltage: exact but for the saturation."""
    current = decay * current + (1.0 - decay) * conductance * voltage
    return min(saturation, max(-saturation, current))


@inlined
def spool_step(position, velocity, target, new_target, propagator):
    """Equation (2) over one step in which its target moves as a current does: position and velocity at its end.

    propagator: for position and velocity each: from position, from velocity, from the old target, from the new one.
    """
    new_position = propagator[0] * position + propagator[1] * velocity + propagator[2] * target
    new_velocity = propagator[4] * position + propagator[5] * velocity + propagator[6] * target
    return new_position + propagator[3] * new_target, new_velocity + propagator[7] * new_target


@inlined
def port_flows(opening, gain, conductance, pressure_a, pressure_b, supply_pressure, return_pressure):
    """Equation (3), the laminar flow of the lands beside it, and what the supply gives and the return line takes."""
    flow_a, flow_b, fall_a, rise_b = orifices(opening, gain, pressure_a, pressure_b, supply_pressure, return_pressure)
    drawn, returned = (flow_a, flow_b) if opening >= 0.0 else (-flow_b, -flow_a)
    if conductance > 0.0:
        flow_a += conductance * (supply_pressure + return_pressure - 2.0 * pressure_a)
        flow_b -= conductance * (supply_pressure + return_pressure - 2.0 * pressure_b)
        fall_a += 2.0 * conductance
        rise_b += 2.0 * conductance
        drawn += conductance * (2.0 * supply_pressure - pressure_a - pressure_b)
        returned += conductance * (pressure_a + pressure_b - 2.0 * return_pressure)
    return flow_a, flow_b, fall_a, rise_b, drawn, returned


@inlined
def oil_step(
    tau, ports, chambers, position, velocity, pressure_a, pressure_b, area_a, stroke, line, atmospheric_pressure
):
    """Equations (4) to (9) over the time tau with the piston moving steadily through `position`.

    ports: what `port_flows` says. chambers: what the hook `chamber` says. Returns both pressures and the oil's
    stiffness as the piston feels it.
    """
    flow_a, flow_b, fall_a, rise_b, _, _ = ports
    area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross, cross_slope, leak_a, leak_b = chambers
    volume_a, volume_b = volumes(position, area_a, area_b, stroke, line)
    # beta / V of each chamber, by one division for the two
    inverse = 1.0 / (volume_a * volume_b)
    spring_a = bulk_a * volume_b * inverse
    spring_b = bulk_b * volume_a * inverse
    outside_a, outside_b = external_leakage_flow(leak_a, pressure_a), external_leakage_flow(leak_b, pressure_b)
    net_a, net_b = net_flows(flow_a, flow_b, cross, outside_a, outside_b, velocity, area_a, area_b)
    # z = tau J; the step is (1 - z + z^2/2)^-1 (1 - z/2) tau f, exponential Rosenbrock-Euler to its second order.
    # In z's trace and determinant (Cayley, Hamilton) it has no differences of large numbers, however strong the leakage
    z_ab = tau * spring_a * cross_slope
    z_ba = tau * spring_b * cross_slope
    own_a = tau * spring_a * (bulk_change_a * net_a - fall_a - leak_a)
    own_b = tau * spring_b * (bulk_change_b * net_b - rise_b - leak_b)
    f_a = tau * spring_a * net_a
    f_b = tau * spring_b * net_b
    trace = own_a + own_b - z_ab - z_ba
    determinant = own_a * own_b - own_a * z_ba - own_b * z_ab
    shared = 1.0 - trace + 0.5 * trace * trace - 0.25 * determinant * trace
    scale = 1.0 / (shared - 0.25 * determinant * (trace - determinant))
    once = (0.5 - 0.5 * trace + 0.25 * determinant) * scale
    change_a = shared * scale * f_a + once * (own_a * f_a + z_ab * (f_b - f_a))
    change_b = shared * scale * f_b + once * (own_b * f_b + z_ba * (f_a - f_b))
    pressure_a = max(-atmospheric_pressure, pressure_a + change_a)
    pressure_b = max(-atmospheric_pressure, pressure_b + change_b)
    return pressure_a, pressure_b, area_a * area_a * spring_a + area_b * area_b * spring_b


@inlined
def effective_velocity(tau, position, velocity, stroke):
    """The speed that, over the time tau, lands a piston on the stroke's end where `velocity` would carry it past."""
    reached = position + tau * velocity
    return (copysign(stroke, reached) - position) / tau if abs(reached) > stroke else velocity


@inlined
def mass_in_step(mass, stiff):
    """The mass of a step whose springs add up to `stiff` / step^2: numerator and denominator, to save a division.

    It is mass + theta stiff with theta = (mass + stiff) / (4 (3 mass + stiff)).
    """
    thin = 3.0 * mass + stiff
    return mass * thin + 0.25 * stiff * (mass + stiff), thin


@inlined
def implicit_mass(mass, stiff, drag):
    """The mass to which a force, taken at the velocity at a step's start, gives the change of `velocity_step`.

    stiff, drag: stiffness times step^2, damping times step.
    """
    bulky, thin = mass_in_step(mass, stiff)
    bulky /= thin
    drag = max(drag, -bulky)
    return bulky + drag * (bulky + drag) / (2.0 * bulky + drag)


@inlined
def velocity_step(step_size, position, velocity, driving, resistance, oil_stiffness, mass, spring, stroke):
    """Equation (10) over one step at a held position: the velocity at its end.

    driving: the pressures' force less the spring's. resistance: what the hook `force` says.
    """
    other, damping, stop_stiffness, dry = resistance
    bulky, thin = mass_in_step(mass, step_size * step_size * (oil_stiffness + spring + stop_stiffness))
    drag = step_size * thin * damping
    # friction that falls faster over the speed than the step can follow is taken at the speed at its start, that much
    steep = max(0.0, -bulky - drag)
    drag += steep
    inverse = 1.0 / (bulky * bulky + drag * (bulky + 0.5 * drag))
    shrink = bulky * bulky * inverse
    impulse = step_size * thin * (bulky + 0.5 * drag) * inverse
    new = shrink * velocity + impulse * (driving + other)
    if dry > 0.0:
        held = impulse * dry - (bulky + 0.5 * drag) * inverse * steep * abs(velocity)
        new = max(0.0, new - held) if new > 0.0 else min(0.0, new + held)
    return effective_velocity(0.5 * step_size, position, new, stroke)


@inlined
def friction_force(step_size, velocity, new, driving, damping, stop_stiffness, oil_stiffness, mass, spring):
    """F_f of (10) over a step that took `velocity` to `new`: what is neither pressure, spring nor B_s (`damping`)."""
    bulky, thin = mass_in_step(mass, step_size * step_size * (oil_stiffness + spring + stop_stiffness))
    return driving - damping * 0.5 * (velocity + new) - bulky / (step_size * thin) * (new - velocity)


@inlined
def held_at_the_ends(position, velocity, stroke):
    """A piston at an end of its stroke moves inwards or not at all."""
    if position >= stroke:
        return stroke, min(velocity, 0.0)
    if position <= -stroke:
        return -stroke, max(velocity, 0.0)
    return position, velocity
