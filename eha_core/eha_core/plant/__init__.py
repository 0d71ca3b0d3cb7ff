"""The actuator: `Plant` simulates it, `simulate_many` many at once, `COLUMNS` names what they report; `derivatives` is
its nominal equations and `linearise` their first order. `compose` puts another actuator together than the
paper's, and `load_nominal` reads which one a file means."""

from eha_core.plant.composition import PAPER, Composition, compose
from eha_core.plant.continuous import derivatives
from eha_core.plant.linear import LinearPlant, linearise
from eha_core.plant.many import Trajectories, simulate_many
from eha_core.plant.nominal_file import NominalPlant, composition_of, load_nominal, voltage_driven
from eha_core.plant.simulator import Plant, Trajectory
from eha_core.plant.state import COLUMNS, SEEN, Row, State

__all__ = [
    "COLUMNS", "PAPER", "SEEN", "Composition", "LinearPlant", "NominalPlant", "Plant", "Row", "State", "Trajectories",
    "Trajectory", "compose", "composition_of", "derivatives", "linearise", "load_nominal", "simulate_many",
    "voltage_driven",
]
