"""How well models explain and predict: of each channel, each recording, each step from nominal to augmented."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from eha_core.diagnosis.result.findings import Location


@dataclass(frozen=True)
class Explained:
    """How much the fitted model explains, and the residual.

    `share` is the part of the recalibrated nominal model's squared error beyond noise that it takes away, `times_noise`
    the RMS of each channel's residual over that channel's noise, in the fit or on held-out windows, whichever is
    more. `complete` says that the residual has the size of noise and is white, and that each named effect's strength is
    identified; `vague` that only the second fails. Where the first does, `left_over` says where and when it
    sits.
    """

    share: float
    times_noise: Mapping[str, float]
    complete: bool
    left_over: tuple[Location, ...] = ()
    vague: bool = False


@dataclass(frozen=True)
class Residual:
    """What a model leaves: the RMS of its residual over the noise, of each channel and of all samples together."""

    times_noise: Mapping[str, float]
    overall: float


NOMINAL, RECALIBRATED, AUGMENTED = "nominal", "recalibrated", "augmented"
"""The nominal model as given, with its parameters fitted, and with all effects that were found."""


@dataclass(frozen=True)
class Step:
    """A model and what it leaves; `added` is what it has beyond the one before: NOMINAL, RECALIBRATED, AUGMENTED."""

    added: str
    residual: Residual


@dataclass(frozen=True)
class Correlation:
    """How the errors of the final model's fitted parameters depend on each other: coefficients from -1 to 1, (n, n) for
    n `names`. Near 1 or -1, the recording tells the two only together."""

    names: tuple[str, ...] = ()
    matrix: tuple[tuple[float, ...], ...] = ()


@dataclass(frozen=True)
class ChannelFit:
    """RMSE of one channel [its unit]: nominal as given, calibrated, and with the named physics; and its noise."""

    rmse_before: float
    rmse_calibrated: float
    rmse_after: float
    noise: float


@dataclass(frozen=True)
class Prediction:
    """RMSE [the channel's unit] of the fitted model where no state was fitted.

    `ahead`: by the seconds that it runs on from states that were measured; `free_running`: over the whole record from
    its first state.
    """

    ahead: Mapping[float, float]
    free_running: float


@dataclass(frozen=True)
class RecordingFit:
    """One of several recordings that one model was fitted to: its path, the values that are its own, and its channels
    on held-out windows."""

    path: str
    own_values: Mapping[str, float]
    held_out: Mapping[str, ChannelFit]


@dataclass(frozen=True)
class PredictedRecording:
    """A recording that nothing was fitted to: how the nominal, the recalibrated and the augmented model (by these
    names) predict each channel, and the channels' noise [their unit]."""

    path: str
    prediction: Mapping[str, Mapping[str, Prediction]]
    noise: Mapping[str, float]


@dataclass(frozen=True)
class TraceStep:
    """One fit of the search: what led to it, the set's effects, the chi^2 a sample that it ended at, and the CPU time
    [s] since the search began."""

    step: str
    effects: tuple[str, ...]
    chi2: float
    cpu_s: float
