"""The report's story: one stage of the diagnosis, one file; each makes a `Stage` from the result."""

from __future__ import annotations

from eha_core.diagnosis.result import Diagnosis
from eha_core.report.stage import Stage
from eha_core.report.stages import calibrate, locate, model, name, next_experiment, read, show

_ORDER = (read, calibrate, locate, name, model, show, next_experiment)


def story(diagnosis: Diagnosis) -> tuple[Stage, ...]:
    """The stages in the order in which the diagnosis came to its verdict."""
    return tuple(one.stage(diagnosis) for one in _ORDER)
