"""The contents that the page and the figures share, made once."""

from __future__ import annotations

from dataclasses import dataclass

from eha_core.diagnosis.result import Diagnosis
from eha_core.report.first_screen import pictures
from eha_core.report.laws import laws
from eha_core.report.picture import Picture
from eha_core.report.stage import Stage
from eha_core.report.stages import report_stages


@dataclass(frozen=True)
class Contents:
    """The pictures of the first screen, and the stages below it."""

    first_screen: tuple[Picture, ...]
    stages: tuple[Stage, ...]

    @property
    def figures(self) -> tuple[Picture, ...]:
        """The pictures that are written as files; those of a stage's parts are all on the first screen."""
        return (*self.first_screen, *(picture for stage in self.stages for picture in stage.pictures))


def contents_of(diagnosis: Diagnosis) -> Contents:
    """All pictures and stages of a diagnosis."""
    found = laws(diagnosis)
    return Contents(pictures(diagnosis, found), report_stages(diagnosis, found))
