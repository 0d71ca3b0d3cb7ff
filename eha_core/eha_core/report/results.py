"""A diagnosis for a Python session or a notebook: values, a summary in tables, plots, and files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from eha_core.diagnosis.result import Alternative, Diagnosis, FittedParameter, Location, NamedEffect
from eha_core.errors import EhaError
from eha_core.motion_given import Found
from eha_core.report.contribution import ladder_picture
from eha_core.report.document import as_json, document
from eha_core.report.first_screen import law_picture, residual_picture
from eha_core.report.picture import Picture
from eha_core.report.stages import report_stages
from eha_core.report.stages.model import correlations
from eha_core.report.summary_tables import Summary, summarise

if TYPE_CHECKING:
    from eha_core.report.figures import Drawn


def drawn(picture: Picture) -> Drawn:
    """The picture as a figure; matplotlib loads slowly, and not every session draws."""
    from eha_core.report.figures import drawn as as_figure

    return as_figure(picture)


class Plots:
    """The report's pictures, one for each method, as matplotlib figures that a notebook shows."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        self._diagnosis = diagnosis
        self._stages = {stage.name: stage for stage in report_stages(diagnosis)}

    def recording(self) -> Drawn:
        """The recorded channels, with the held-out intervals."""
        return self._picture("read")

    def parameters(self) -> Drawn:
        """The fitted parameters of the nominal model as departures from their nominal values, with 95 % intervals."""
        return self._picture("calibrate")

    def equations(self) -> Drawn:
        """Each equation's residual, over time and over the variable that it depends on most."""
        return self._picture("locate")

    def evidence(self) -> Drawn:
        """How far each hypothesis falls behind the best."""
        return self._picture("name")

    def law(self) -> Drawn:
        """The missing physics as a law in SI units: the data, the fitted law, and the nominal model."""
        picture = law_picture(self._diagnosis)
        return drawn(picture) if picture else self._picture("model")

    def ladder(self) -> Drawn:
        """The residual of each model, from the nominal one over those without one effect to the complete set."""
        picture = ladder_picture(self._diagnosis)
        if picture is None:
            raise EhaError("there is nothing to plot here: this diagnosis has no residual for each model")
        return drawn(picture)

    def correlation(self) -> Drawn:
        """The correlation of the fitted parameters' errors."""
        picture = correlations(self._diagnosis)
        if picture is None:
            raise EhaError("there is nothing to plot here: fewer than two parameters were fitted")
        return drawn(picture)

    def residuals(self) -> Drawn:
        """The residuals of the nominal and of the final model over time."""
        return drawn(residual_picture(self._diagnosis))

    def overlays(self) -> Drawn:
        """Measured and modelled channels, and the residuals, on the held-out data."""
        return self._picture("show")

    def whiteness(self) -> Drawn:
        """Autocorrelation of the residuals, which white noise keeps within a band."""
        return self._picture("show", 1)

    def _picture(self, stage: str, place: int = 0) -> Drawn:
        pictures: tuple[Picture, ...] = self._stages[stage].pictures
        if len(pictures) <= place:
            raise EhaError(f"there is nothing to plot here: {self._stages[stage].headline.lower()}")
        return drawn(pictures[place])


class MotionPlots:
    """The picture of a law of given motion; it returns a matplotlib figure."""

    def __init__(self, found: Found) -> None:
        self._found = found

    def law(self) -> Drawn:
        """The force and the law's residual, over speed and over position."""
        from eha_core.report.motion_given import law_picture

        return drawn(law_picture(self._found))

    def __getattr__(self, name: str) -> NoReturn:
        raise EhaError(f"there is no plot {name!r}: the motion is given and nothing was simulated; there is plot.law()")


class Results:
    """The result of `diagnose`.

    Attributes:
        diagnosis: the whole result, frozen.
    """

    def __init__(self, diagnosis: Diagnosis) -> None:
        self.diagnosis = diagnosis

    @property
    def verdict(self) -> str:
        """consistent, parameters, missing_physics, ambiguous or unknown_physics."""
        return self.diagnosis.verdict

    @property
    def effects(self) -> tuple[NamedEffect, ...]:
        """The missing effects, each with its parameters and their standard deviations."""
        return self.diagnosis.effects

    @property
    def parameters(self) -> tuple[FittedParameter, ...]:
        """The parameters of the nominal model as fitted."""
        return self.diagnosis.parameters

    @property
    def alternatives(self) -> tuple[Alternative, ...]:
        """Other explanations that this recording cannot distinguish from `effects`."""
        return self.diagnosis.alternatives

    @property
    def location(self) -> tuple[Location, ...]:
        """Where and when the nominal equations fail, most important first."""
        return self.diagnosis.location

    @property
    def fitted_values(self) -> Mapping[str, float]:
        """Values that differ from the catalogue's nominal plant: `eha.simulate(..., parameters=...)` takes them."""
        return self.diagnosis.fitted_values

    @property
    def plot(self) -> Plots | MotionPlots:
        """The pictures."""
        return Plots(self.diagnosis)

    def summary(self) -> Summary:
        """Tables of what is missing, what changed, and how large the errors are; print it, or show it in a notebook."""
        return summarise(self.diagnosis)

    def to_dict(self) -> dict[str, Any]:
        """The content of diagnosis.json."""
        return document(self.diagnosis)

    def to_json(self, path: str | Path | None = None) -> str:
        """The text of diagnosis.json; also written to `path`, if given."""
        text = as_json(self.diagnosis)
        if path is not None:
            Path(path).write_text(text, encoding="utf-8")
        return text

    def save(self, folder: str | Path) -> tuple[Path, ...]:
        """Write the report, its figures, diagnosis.json, fitted.yaml and comparison.mcap; returns their paths."""
        from eha_core.report.files import write_report

        return write_report(self.diagnosis, Path(folder))

    def __repr__(self) -> str:
        return f"<Results: {self.diagnosis.summary}>"

    def _repr_html_(self) -> str:
        return self.summary()._repr_html_()


class MotionResults(Results):
    """The result of `diagnose` where the motion is given and the force is the response."""

    def __init__(self, found: Found) -> None:
        super().__init__(found.diagnosis)
        self._found = found

    @property
    def plot(self) -> MotionPlots:
        """The picture of the law."""
        return MotionPlots(self._found)

    def save(self, folder: str | Path) -> tuple[Path, ...]:
        """Write diagnosis.json and the figure of the law; returns their paths."""
        from eha_core.report.motion_given import write_motion_given

        return write_motion_given(self._found, Path(folder))
