"""A rig that investigates itself: a series of tests, each chosen by the diagnosis of all tests before it."""

from eha_core.investigation.ending import ENDINGS, Ending
from eha_core.investigation.loop import MARGIN, Bounds, Investigation, Step, investigate
from eha_core.investigation.motion import Motion, MotionStopped, Rig, from_mid_stroke
from eha_core.investigation.voltage_test import VoltageTest, first_test
from eha_core.investigation.watch import Watch

__all__ = [
    "ENDINGS",
    "MARGIN",
    "Bounds",
    "Ending",
    "Investigation",
    "Motion",
    "MotionStopped",
    "Rig",
    "Step",
    "VoltageTest",
    "Watch",
    "first_test",
    "from_mid_stroke",
    "investigate",
]
