"""The actuator: `Plant` simulates it, `simulate_many` many at once, `COLUMNS` names what they report; `derivatives` is
its nominal equations and `linearise` their first order. `CoupledPlant` acts on a load that another simulation moves.
`compose` puts another actuator together than the paper's, and `load_plant` reads which one a file means."""

from eha_core.plant.composition import PAPER, Composition, compose
from eha_core.plant.continuous import derivatives
from eha_core.plant.coupled import CoupledPlant, Reaction
from eha_core.plant.linear import LinearPlant, linearise
from eha_core.plant.many import Trajectories, simulate_many
from eha_core.plant.plant_file import (
    GivenPlant,
    composition_of,
    dump_plant,
    load_plant,
    require_sliding,
    voltage_driven,
)
from eha_core.plant.simulator import Plant, Trajectory
from eha_core.plant.state import COLUMNS, SEEN, Row, State

__all__ = [
    "COLUMNS",
    "PAPER",
    "SEEN",
    "Composition",
    "CoupledPlant",
    "GivenPlant",
    "LinearPlant",
    "Plant",
    "Reaction",
    "Row",
    "State",
    "Trajectories",
    "Trajectory",
    "compose",
    "composition_of",
    "derivatives",
    "dump_plant",
    "linearise",
    "load_plant",
    "require_sliding",
    "simulate_many",
    "voltage_driven",
]
