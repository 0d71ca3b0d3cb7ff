"""The actuator: `Plant` simulates it, `simulate_many` many at once, `COLUMNS` names what they report; `derivatives` is
its nominal equations and `linearise` their first order."""

from eha_core.plant.continuous import derivatives
from eha_core.plant.linear import LinearPlant, linearise
from eha_core.plant.many import Trajectories, simulate_many
from eha_core.plant.simulator import Plant, Trajectory
from eha_core.plant.state import COLUMNS, SEEN, Row, State

__all__ = [
    "COLUMNS", "SEEN", "LinearPlant", "Plant", "Row", "State", "Trajectories", "Trajectory", "derivatives", "linearise",
    "simulate_many",
]
