"""The compiled actuator: `Plant` simulates it, `COLUMNS` names what it reports."""

from eha_core.plant.simulator import COLUMNS, Plant, State, Trajectory

__all__ = ["COLUMNS", "Plant", "State", "Trajectory"]
