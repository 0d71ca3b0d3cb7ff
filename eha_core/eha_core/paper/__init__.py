"""The published experiment, from the library alone: Tables 2 and 3 and the data of Figures 3 to 5.

Source: Shern, Ghazali, Soon, Sam, Rahmat, "Position Tracking Performance for Electro-Hydraulic Actuator System with the
Presence of Actuator Internal Leakage".
"""

from eha_core.paper.experiment import Experiment, Reproduction, reproduce
from eha_core.paper.level import Level, Sweep, closed_form, measure
from eha_core.paper.printed import LEFT_OPEN, LEVELS, PRINTED_RMSE
from eha_core.paper.table import as_json, as_markdown

__all__ = [
    "LEFT_OPEN",
    "LEVELS",
    "PRINTED_RMSE",
    "Experiment",
    "Level",
    "Reproduction",
    "Sweep",
    "as_json",
    "as_markdown",
    "closed_form",
    "measure",
    "reproduce",
]
