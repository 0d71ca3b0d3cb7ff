"""The complete result of a diagnosis, with the series that the report draws."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from eha_core.diagnosis.result.detection import Undetected
from eha_core.diagnosis.result.findings import (
    Alternative,
    CommonScale,
    Experiment,
    FittedParameter,
    Location,
    NamedEffect,
    ProbableSet,
    UnknownLaw,
)
from eha_core.diagnosis.result.long_record import LongRecord
from eha_core.diagnosis.result.residuals import (
    ChannelFit,
    Correlation,
    Explained,
    PredictedRecording,
    Prediction,
    RecordingFit,
    Residual,
    Step,
    TraceStep,
)
from eha_core.health import Fault
from eha_core.identification.numbers import Array
from eha_core.plant import PAPER, Composition

VERDICTS = ("consistent", "parameters", "missing_physics", "ambiguous", "unknown_physics")


@dataclass(frozen=True)
class Pictures:
    """The series that the report draws, by name; channels in SI, each over its own `time` [s].

    `measured` has every channel that was used, including inputs; the three models have those that are compared.
    `variables` (states of the recalibrated model, by column name) have their own `time`. `equations` has each
    equation's residual in units of its noise, as (time, residual). `held_out`: the held-out intervals [s]. `span`:
    begin and end of the stretch of a long record that is drawn [s].
    """

    time: Mapping[str, Array]
    measured: Mapping[str, Array]
    before: Mapping[str, Array]
    calibrated: Mapping[str, Array]
    after: Mapping[str, Array]
    variables: Mapping[str, Array] = field(default_factory=dict)
    equations: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)
    held_out: tuple[tuple[float, float], ...] = ()
    span: tuple[float, float] | None = None


@dataclass(frozen=True)
class Diagnosis:
    """The complete result of `eha diagnose`.

    With several recordings of one rig, `path` and all figures are of the one with the largest residual; `together` has
    a row for each, and `tests` one for each recording that nothing was fitted to.

    `rivals` has every hypothesis that was refitted, the best first, with its score: its gain in chi^2 over the
    recalibrated model minus the cost of its parameters. `whiteness` is each channel's largest autocorrelation in
    standard deviations of white noise's. `start_stamp` is the instant [ns] of time zero. `provenance`: version, input
    and date, as text. `steps` lead from the nominal model to that with all effects; `without` has the residuals without
    each of several effects, with the rest refitted, the largest first, which is also the order of `effects`. `sets`
    are those that together have 95 % of the probability, the most probable first; `trace` has every fit of the search.
    `health` has the faults of the channels, each with the number of its recording (1 for a single one). `event`: the
    only interval in which the nominal model fails [s]. `scale`: the common factor of the changed parameters, if there
    is one. `long_records` has those of which only stretches were fitted; figures of them use the record's time.
    `undetected`: upper limits of further effects; None where the residual exceeds the noise.
    """

    path: str
    duration: float
    channels: tuple[str, ...]
    not_examined: tuple[str, ...]
    remarks: tuple[str, ...]
    verdict: str
    summary: str
    location: tuple[Location, ...]
    parameters: tuple[FittedParameter, ...]
    effects: tuple[NamedEffect, ...]
    alternatives: tuple[Alternative, ...]
    unknown: UnknownLaw | None
    next_experiment: Experiment | None
    rivals: tuple[tuple[tuple[str, ...], float], ...]
    whiteness: Mapping[str, float]
    fitted_values: Mapping[str, float]
    pictures: Pictures
    start_stamp: int = 0
    damaged: str | None = None
    training: Mapping[str, ChannelFit] = field(default_factory=dict)
    held_out: Mapping[str, ChannelFit] = field(default_factory=dict)
    explained: Explained = field(default_factory=lambda: Explained(1.0, {}, True))
    prediction: Mapping[str, Prediction] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)
    together: tuple[RecordingFit, ...] = ()
    tests: tuple[PredictedRecording, ...] = ()
    steps: tuple[Step, ...] = ()
    without: Mapping[str, Residual] = field(default_factory=dict)
    correlation: Correlation = Correlation()
    composition: Composition = PAPER
    long_records: tuple[LongRecord, ...] = ()
    sets: tuple[ProbableSet, ...] = ()
    trace: tuple[TraceStep, ...] = ()
    health: tuple[tuple[int, Fault], ...] = ()
    event: tuple[float, float] | None = None
    scale: CommonScale | None = None
    undetected: Undetected | None = None

    @property
    def drawn(self) -> tuple[float, float]:
        """Begin and end of the figures' time axis [s]."""
        return self.pictures.span or (0.0, self.duration)

    @property
    def biased(self) -> bool:
        """Whether the parameters were fitted without a law that is known to be missing, and may compensate for it."""
        simulated = any(name.startswith("recovered_") for name in self.fitted_values)
        return self.verdict == "unknown_physics" and not simulated
