"""The report's stages, one file each, which makes a `Stage` from the diagnosis."""

from __future__ import annotations

from collections.abc import Mapping

from eha_core.diagnosis.result import Diagnosis
from eha_core.report.laws import Law, laws
from eha_core.report.stage import Stage
from eha_core.report.stages import calibrate, locate, model, name, next_experiment, read, show


def report_stages(diagnosis: Diagnosis, found: Mapping[str, Law] | None = None) -> tuple[Stage, ...]:
    """The stages in the order of the diagnosis; `found`: the laws, if already known."""
    found = laws(diagnosis) if found is None else found
    return (
        read.stage(diagnosis),
        calibrate.stage(diagnosis),
        locate.stage(diagnosis),
        name.stage(diagnosis),
        model.stage(diagnosis, found),
        show.stage(diagnosis),
        next_experiment.stage(diagnosis),
    )
