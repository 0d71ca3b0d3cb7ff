"""The results of all stages up to the decision, for the recordings of one rig."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.calibrate import Calibration
from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.result import Location
from eha_core.diagnosis.search.comparison import ModelComparison
from eha_core.diagnosis.unknown import Recovery
from eha_core.diagnosis.verdict import Decision
from eha_core.identification.fit import Fit
from eha_core.identification.observation import Observation
from eha_core.identification.shooting import Shooting
from eha_core.identification.together import fit_alone, recording_alone
from eha_core.weak_form.equation_residuals import EquationResidual


@dataclass(frozen=True)
class Evidence:
    """Every stage's result, in their order.

    Attributes:
        observations: one for each recording; `lead` is the number, counted from one, of the one that the report shows.
        equation_residuals: of the lead recording, those of each model; `equations`: the smallest of them.
    """

    observations: tuple[Observation, ...]
    lead: int
    nominal: Mapping[str, float]
    calibration: Calibration
    scales: Scales
    equations: tuple[EquationResidual, ...]
    equation_residuals: tuple[tuple[EquationResidual, ...], ...]
    comparison: ModelComparison
    recovery: Recovery | None
    decision: Decision
    location: tuple[Location, ...]

    @property
    def observation(self) -> Observation:
        """The lead recording's observation."""
        return self.observations[self.lead - 1]

    def shown(self, shooting: Shooting) -> Shooting:
        """The lead recording's windows."""
        return recording_alone(shooting, self.lead)

    def shown_fit(self, shooting: Shooting, result: Fit) -> Fit:
        """The lead recording's part of a fit to these windows."""
        return fit_alone(shooting, result, self.lead)


def recording_with_largest_residual(shooting: Shooting, fitted: Fit) -> int:
    """The number, counted from one, of the recording with the largest chi^2 per sample."""
    each = [fit_alone(shooting, fitted, number) for number in range(1, len(shooting.first_windows) + 1)]
    return 1 + int(np.argmax([result.data / max(result.count, 1) for result in each]))
