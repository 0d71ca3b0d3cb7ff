"""The tracking error due to each departure of a rig from its model: shares of the RMSE, and the gain of each repair."""

from eha_core.error_budget.rig import Departure, Rig, rig_from_changes, rig_from_document
from eha_core.error_budget.shares import Budget, RepairStep, Share, error_budget
from eha_core.error_budget.task import Task

__all__ = [
    "Budget",
    "Departure",
    "RepairStep",
    "Rig",
    "Share",
    "Task",
    "error_budget",
    "rig_from_changes",
    "rig_from_document",
]
