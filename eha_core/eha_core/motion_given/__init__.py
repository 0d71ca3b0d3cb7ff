"""Friction and load laws where the motion is given and the force is the answer: test benches, dampers, seals, axes.

Nothing has to be simulated but a friction law's own state, which the measured motion drives. So the law is a regression
of the measured force: a few terms of friction, spring and inertia, chosen on stretches of the recording that their fit
has not seen.
"""

from eha_core.motion_given.diagnose import Found, diagnose_motion
from eha_core.motion_given.law import Law, fit_law, predict
from eha_core.motion_given.motion import Motion, is_motion_given, motion_of
from eha_core.motion_given.search import find_law

__all__ = [
    "Found",
    "Law",
    "Motion",
    "diagnose_motion",
    "find_law",
    "fit_law",
    "is_motion_given",
    "motion_of",
    "predict",
]
