"""How well models explain and predict each channel, in each recording and for each step from nominal to augmented."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from eha_core.diagnosis.result.findings import Location


@dataclass(frozen=True)
class Explained:
    """How much the fitted model explains, and the residual.

    `share`: the part of the recalibrated model's excess chi^2 that it explains. `times_noise`: the RMS of each
    channel's residual in units of its noise, of training or held-out windows, whichever is larger. `complete`: the
    residual is as small as the noise and white, and each named effect's strength is identified; `vague`: only the
    latter fails. Where the residual is not noise, `left_over` has its sites and intervals.
    """

    share: float
    times_noise: Mapping[str, float]
    complete: bool
    left_over: tuple[Location, ...] = ()
    vague: bool = False


@dataclass(frozen=True)
class Residual:
    """The RMS of a model's residual in units of the noise, of each channel and of all samples together."""

    times_noise: Mapping[str, float]
    overall: float


NOMINAL, RECALIBRATED, AUGMENTED = "nominal", "recalibrated", "augmented"
"""The nominal model as given, with its parameters fitted, and with all effects that were found."""


@dataclass(frozen=True)
class Step:
    """A model and its residual; `added`: NOMINAL, RECALIBRATED or AUGMENTED."""

    added: str
    residual: Residual


@dataclass(frozen=True)
class Correlation:
    """Correlation of the errors of the final model's fitted parameters: coefficients from -1 to 1, (n, n) for n
    `names`. Near 1 or -1, the recording identifies only a combination of the two."""

    names: tuple[str, ...] = ()
    matrix: tuple[tuple[float, ...], ...] = ()


@dataclass(frozen=True)
class ChannelFit:
    """RMSE of one channel [its unit] under the nominal, recalibrated and augmented models; and its noise."""

    rmse_before: float
    rmse_calibrated: float
    rmse_after: float
    noise: float


@dataclass(frozen=True)
class Prediction:
    """RMSE [the channel's unit] of the fitted model's predictions, without fitted states.

    `ahead`: by the horizon [s] from measured states; `free_running`: over the whole record from its first state.
    """

    ahead: Mapping[float, float]
    free_running: float


@dataclass(frozen=True)
class RecordingFit:
    """One of several recordings that one model was fitted to: its path, its own values, and its channels on held-out
    windows."""

    path: str
    own_values: Mapping[str, float]
    held_out: Mapping[str, ChannelFit]


@dataclass(frozen=True)
class PredictedRecording:
    """A recording that nothing was fitted to: the predictions of each channel by the nominal, the recalibrated and the
    augmented model (by these names), and the channels' noise [their unit]."""

    path: str
    prediction: Mapping[str, Mapping[str, Prediction]]
    noise: Mapping[str, float]


@dataclass(frozen=True)
class TraceStep:
    """One fit of the search: the step that led to it, the set's effects, the final chi^2 per sample, and the CPU time
    [s] since the search began."""

    step: str
    effects: tuple[str, ...]
    chi2: float
    cpu_s: float
