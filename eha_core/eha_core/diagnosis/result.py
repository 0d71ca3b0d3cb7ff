"""What a diagnosis says: frozen facts that the terminal, diagnosis.json and the report present."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from eha_core.health import Fault
from eha_core.identification.numbers import Array
from eha_core.plant import PAPER, Composition

VERDICTS = ("consistent", "parameters", "missing_physics", "ambiguous", "unknown_physics")


@dataclass(frozen=True)
class Location:
    """Where the nominal equations fail: site, its share of the unexplained energy, where in state space, and when
    [s].

    `law_over`: the variable of a recovered law, where the share is that law's. `all_of_stretch`: `when` is a whole
    stretch of a longer record. `alone`: no other equation could be examined.
    """

    site: str
    share: float
    where: str
    when: tuple[tuple[float, float], ...]
    law_over: str = ""
    all_of_stretch: bool = False
    alone: bool = False


@dataclass(frozen=True)
class FittedParameter:
    """A nominal parameter after calibration, with its standard deviation; `changed` if it left its nominal value,
    `at_bound` if the fit would have taken it further than it is believed to go."""

    name: str
    nominal: float
    fitted: float
    std: float
    unit: str
    changed: bool
    note: str = ""
    at_bound: bool = False


@dataclass(frozen=True)
class FittedValue:
    """An effect's parameter with its standard deviation; `interval`: the ends of its 95 % interval where that is none
    of two standard deviations to either side, None for an end that the recording does not tell."""

    value: float
    std: float
    unit: str
    interval: tuple[float | None, float | None] | None = None


@dataclass(frozen=True)
class CommonScale:
    """One factor by which several values differ from the nominal ones, as if one thing were off that they share.

    `of` is what that may be; `parameters` are the names of those that changed by it.
    """

    of: str
    factor: float
    std: float
    parameters: tuple[str, ...]


@dataclass(frozen=True)
class NamedEffect:
    """A physical effect that the recording shows.

    `evidence` is what it gains in chi^2, less what its parameters cost; of one of several effects, what the fit would
    lose without it. `active` is the interval in which it acts [s], None where it always does; `kind` the kind of law
    that it is a form of, if the catalogue has several; `probability` that of the name.
    """

    id: str
    site: str
    equation: str
    parameters: Mapping[str, FittedValue]
    evidence: float
    statement: str
    active: tuple[float, float] | None = None
    kind: str = ""
    probability: float = 1.0


@dataclass(frozen=True)
class Explained:
    """How much the fitted model explains, and what is left.

    `share` is the part of the recalibrated nominal model's squared error beyond noise that it takes away, `times_noise`
    the RMS of what is left in each channel over that channel's noise, in the fit or on held-out windows, whichever is
    more. `complete` says that what is left has the size of noise and is white, and that each named effect's strength is
    told from nothing; `vague` that only the second fails. Where the first does, `left_over` says where and when it
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


@dataclass(frozen=True)
class Step:
    """A model and what it leaves; `added` is what it has beyond the one before: NOMINAL, RECALIBRATED, AUGMENTED."""

    added: str
    residual: Residual


NOMINAL, RECALIBRATED, AUGMENTED = "nominal", "recalibrated", "augmented"
"""The nominal model as given, with its parameters fitted, and with all effects that were found."""


@dataclass(frozen=True)
class Correlation:
    """How the errors of the final model's fitted parameters depend on each other: coefficients from -1 to 1, (n, n) for
    n `names`. Near 1 or -1, the recording tells the two only together."""

    names: tuple[str, ...] = ()
    matrix: tuple[tuple[float, ...], ...] = ()


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


@dataclass(frozen=True)
class ProbableSet:
    """A set of effects that may be what is missing, by their ids, and its probability."""

    effects: tuple[str, ...]
    probability: float


@dataclass(frozen=True)
class Alternative:
    """Effects that explain the recording as well as the named ones, but for `evidence_gap`."""

    effects: tuple[str, ...]
    evidence_gap: float


@dataclass(frozen=True)
class UnknownLaw:
    """A law outside the catalogue, recovered as a curve over one variable, and as an expression where it is simple.

    `function_of` names the variable, and after a comma what the curve is multiplied by, if it is. `r_squared` is the
    share that it explains of what the model lacks beyond noise. `samples`: the curve, (variable, law) in SI.
    """

    site: str
    function_of: str
    expression: str
    r_squared: float
    samples: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class ChannelFit:
    """RMSE of one channel [its unit]: nominal as given, calibrated, and with the named physics; and its noise."""

    rmse_before: float
    rmse_calibrated: float
    rmse_after: float
    noise: float


@dataclass(frozen=True)
class Experiment:
    """A test for the rig whose outcome would tell the rivals apart, as parameters of the reference generator.

    `record`: channels that have to be recorded beside those of the recording, where no voltage alone would tell.
    `duration` [s]: how long the test has to last. `reference` is empty where no such test was made: then `statement`
    says why, and what to record.
    """

    statement: str
    separates: tuple[str, ...]
    reference: Mapping[str, object]
    record: tuple[str, ...] = ()
    duration: float = 10.0


@dataclass(frozen=True)
class JudgedBlock:
    """A block of a long record, from `start` to `end` [s]: whether the fit saw it, and what the nominal model
    (`before`) and the one that was found (`after`) err by in each channel with their parameters held [its unit]."""

    start: float
    end: float
    fitted: bool
    before: Mapping[str, float]
    after: Mapping[str, float]


@dataclass(frozen=True)
class LongRecord:
    """A record of which stretches were fitted, and what the whole of it says of the model that was found.

    Attributes:
        path: where it was read from.
        duration: [s].
        stretches: when those that were fitted begin and end [s].
        window: s after which the piston's state is fitted anew where the models are judged; their parameters are not.
        blocks: the blocks that could be compared, in their order.
        passed_over: s that could not, as those of a rig at rest.
        departs: spans [s] in which the model errs by far more than on any stretch that was fitted.
        statement: all this in words.
    """

    path: str
    duration: float
    stretches: tuple[tuple[float, float], ...]
    window: float
    blocks: tuple[JudgedBlock, ...]
    passed_over: float
    departs: tuple[tuple[float, float], ...]
    statement: str


@dataclass(frozen=True)
class Pictures:
    """The series that the report draws, by name; channels in SI, each over its own `time` [s].

    `measured` has every channel that was used, the driving ones too; the three models have those that are compared.
    `variables` (states of the calibrated model, by column name) stand over their own `time`. `equations` has each
    equation's residual in units of its noise, as (time, residual). `held_out`: the spans of time used for judging [s].
    `span`: when the stretch of a long record that is drawn begins and ends [s].
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
    """The whole result of `eha diagnose`.

    Of several recordings of one rig, `path` and all that is drawn are of the one that tells most; `together` has a row
    for each, and `tests` one for each recording that nothing was fitted to.

    `rivals` has every hypothesis that was refitted, the best first, with its score: what it gains in chi^2 over the
    calibrated model, less the cost of its parameters. `whiteness` is each channel's largest autocorrelation in units of
    the deviation that white noise has. `start_stamp` is the instant [ns] of time zero. `provenance`: which version, on
    what, when, as text. `steps` lead from the nominal model to that with all effects; `without` has what is left
    when one of several effects is taken out and the rest fitted again, most first: the order of `effects`, too.
    `sets` are those that together hold 95 % of the probability, the most probable first; `trace` has every fit of the
    search. `health` has the faults of the channels, each with the number of its recording among several (1 of a single
    one). `event`: when the nominal model fails while it is at the noise at all other times [s]. `scale`: the one factor
    by which the changed parameters differ from the nominal ones, if they do. `long_records` has those of which
    stretches were fitted; what is drawn of them is in the record's time.
    """

    path: str
    duration: float
    channels: tuple[str, ...]
    not_examined: tuple[str, ...]
    remarks: tuple[str, ...]
    damaged: str | None
    verdict: str
    summary: str
    location: tuple[Location, ...]
    parameters: tuple[FittedParameter, ...]
    effects: tuple[NamedEffect, ...]
    alternatives: tuple[Alternative, ...]
    unknown: UnknownLaw | None
    training: Mapping[str, ChannelFit]
    held_out: Mapping[str, ChannelFit]
    next_experiment: Experiment | None
    rivals: tuple[tuple[tuple[str, ...], float], ...]
    whiteness: Mapping[str, float]
    fitted_values: Mapping[str, float]
    pictures: Pictures
    start_stamp: int = 0
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

    @property
    def drawn(self) -> tuple[float, float]:
        """When what is drawn begins and ends [s]."""
        return self.pictures.span or (0.0, self.duration)

    @property
    def biased(self) -> bool:
        """Whether the parameters were fitted without a law that is known to be missing, and may imitate it."""
        simulated = any(name.startswith("recovered_") for name in self.fitted_values)
        return self.verdict == "unknown_physics" and not simulated
