"""A model that runs beside a rig on the same command, and says which of its equations the rig departs from.

In each window the model starts from the rig's measured state, so that it neither drifts away nor hides a departure.
"""

from eha_core.twin.comparison import FROZEN, STALE, Comparison, Settings
from eha_core.twin.twin import Twin

__all__ = ["FROZEN", "STALE", "Comparison", "Settings", "Twin"]
