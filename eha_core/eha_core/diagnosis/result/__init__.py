"""The result of a diagnosis: frozen facts that the terminal, diagnosis.json and the report present."""

from eha_core.diagnosis.result.detection import Confusion, Detectable, Noticeable, Undetected
from eha_core.diagnosis.result.findings import (
    Alternative,
    CommonScale,
    Experiment,
    FittedParameter,
    FittedValue,
    Location,
    NamedEffect,
    ProbableSet,
    UnknownLaw,
)
from eha_core.diagnosis.result.long_record import (
    JudgedBlock,
    LongRecord,
)
from eha_core.diagnosis.result.residuals import (
    AUGMENTED,
    NOMINAL,
    RECALIBRATED,
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
from eha_core.diagnosis.result.whole import (
    VERDICTS,
    Diagnosis,
    Pictures,
)

__all__ = [
    "AUGMENTED",
    "Alternative",
    "ChannelFit",
    "CommonScale",
    "Confusion",
    "Correlation",
    "Detectable",
    "Diagnosis",
    "Experiment",
    "Explained",
    "FittedParameter",
    "FittedValue",
    "JudgedBlock",
    "Location",
    "LongRecord",
    "NOMINAL",
    "NamedEffect",
    "Noticeable",
    "Pictures",
    "PredictedRecording",
    "Prediction",
    "ProbableSet",
    "RECALIBRATED",
    "RecordingFit",
    "Residual",
    "Step",
    "TraceStep",
    "Undetected",
    "UnknownLaw",
    "VERDICTS",
]
