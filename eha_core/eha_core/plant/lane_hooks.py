"""Where effects plug into the lock-step: one function a site, as in `hooks`, here with no effect plugged in.

`eha_core.plant.composite` writes a module of these same names in which each effect's `contribution` is called for every
lane in which it acts. `active` has one bit an effect, set where it acts in any lane; each site's mask has the bits of
its effects.
"""

from __future__ import annotations

from eha_core.compiled import called

COMMAND_EFFECTS = SCHEDULE_EFFECTS = SPOOL_EFFECTS = ORIFICE_EFFECTS = 0
SUPPLY_EFFECTS = CHAMBER_EFFECTS = FORCE_EFFECTS = SENSOR_EFFECTS = 0
"""Which bits of `active` belong to a site."""


@called
def command(block, lanes, active, history, newest, step_size):
    """The voltage that reaches the coil."""


@called
def schedule(block, lanes, active, time):
    """Parameters that change in time."""


@called
def spool(block, lanes, active):
    """The current that the spool follows."""


@called
def orifice(block, lanes, active):
    """How far the ports are open, at which gain, and the laminar conductance of the lands."""


@called
def supply(block, lanes, active, step_size):
    """The pressures at the valve's supply and return ports."""


@called
def chamber(block, lanes, active):
    """What the continuity equations of the chambers are made of."""


@called
def force(block, lanes, active, step_size):
    """Forces on the piston beside pressure and spring."""


@called
def sensor(block, lanes, active, step_size):
    """What the sensors make of the state."""
