"""Where in the actuator an effect can sit: one row a site, in the order in which the signal passes."""

from __future__ import annotations

from typing import NamedTuple


class Site(NamedTuple):
    """A place in the plant at which effects plug in; `eha_core.plant.hooks` has a function of each one's name.

    Attributes:
        words: completes "it sits ...".
        quantities: how many leading arguments of the hook its effects change, and it returns.
    """

    words: str
    quantities: int


SITES = {
    "command": Site("between command and coil", 1),
    "spool": Site("between coil current and spool", 1),
    "orifice": Site("in the valve's flow", 3),
    "supply": Site("in the supply or return line", 2),
    "chamber": Site("in the continuity of the chambers", 9),
    "force": Site("in the force balance of the piston", 4),
    "sensor": Site("in what a sensor reports", 4),
    "schedule": Site("in a parameter that changes in time", 2),
}
