"""Where effects plug into the compiled step: one function a site, here with no effect plugged in.

`eha_core.plant.composite` writes a module of these same names and heads in which every effect of the catalogue is
called in turn. An effect's `contribution` takes the quantities that its site lists below, then the site's context
(after `/`), then the effect's own parameters in the order of its declaration; it returns the quantities as it leaves
them. SI units throughout.

* command: voltage / history, newest, step_size
* schedule: internal_leakage, damping / time
* spool: target (the current that the spool follows) / memory, slot
* orifice: opening, gain, conductance (laminar, supply to port and port to return) / spool_position
* supply: supply_pressure, return_pressure / supply_flow, return_flow, memory, slot, step_size
* chamber: area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross_flow, cross_slope, leakage_a, leakage_b /
  position, pressure_a, pressure_b, atmospheric_pressure
* force: force, damping, stiffness, dry_friction / position, velocity, pressure_a, pressure_b, memory, slot, step_size
* sensor: position, velocity, pressure_a, pressure_b / memory, slot, step_size

`history` holds one voltage a step in a ring, the latest at index `newest`, and in its last element that index. `memory`
holds the effects' own states; an effect's is at `slot`, and of several each has an argument of its own, named slot_...
`bulk_change` is d ln(bulk) / dP in the chamber's own pressure; `cross_slope` the derivative of cross_flow (positive
from A to B) in pressure_a - pressure_b. `force` acts along positive position; `damping` and `stiffness` are the linear
parts that the step treats implicitly (the force of the stiffness is in `force`); the piston sticks where the rest of
the force is below `dry_friction`. Pressures are above the return line's reference.
"""

from __future__ import annotations

from eha_core.compiled import inlined

# Heads must match the generated ones, so arguments that no nominal physics uses stand here too.


@inlined
def command(voltage, history, newest, step_size, parameters, active):
    """The voltage that reaches the coil."""
    return voltage


@inlined
def schedule(internal_leakage, damping, time, parameters, active):
    """Parameters that change in time."""
    return internal_leakage, damping


@inlined
def spool(target, memory, parameters, active):
    """The current that the spool follows."""
    return target


@inlined
def orifice(opening, gain, conductance, spool_position, parameters, active):
    """How far the ports are open, at which gain, and the laminar conductance of the lands."""
    return opening, gain, conductance


@inlined
def supply(supply_pressure, return_pressure, supply_flow, return_flow, memory, step_size, parameters, active):
    """The pressures at the valve's supply and return ports."""
    return supply_pressure, return_pressure


@inlined
def chamber(
    area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross_flow, cross_slope, leakage_a, leakage_b,
    position, pressure_a, pressure_b, atmospheric_pressure, parameters, active,
):  # fmt: skip
    """What the continuity equations of the chambers are made of."""
    return area_b, bulk_a, bulk_change_a, bulk_b, bulk_change_b, cross_flow, cross_slope, leakage_a, leakage_b


@inlined
def force(
    force, damping, stiffness, dry_friction,
    position, velocity, pressure_a, pressure_b, memory, step_size, parameters, active,
):  # fmt: skip
    """Forces on the piston beside pressure and spring."""
    return force, damping, stiffness, dry_friction


@inlined
def sensor(position, velocity, pressure_a, pressure_b, memory, step_size, parameters, active):
    """What the sensors make of the state."""
    return position, velocity, pressure_a, pressure_b
