"""What each departure of a rig from its model costs in tracking error: shares of the RMSE, and what a repair gains."""

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
