"""The virtual electro-hydraulic servo actuator: simulator, recordings, and the diagnosis of what a model leaves out.

    import eha_core as eha

    recording = eha.Recording.from_dataframe(frame)
    found = eha.diagnose(recording)
    print(found.summary())

Nothing below is imported before it is used: compilers and plotting load slowly.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from eha_core.version import __version__

if TYPE_CHECKING:
    from eha_core.api import catalogue, diagnose, read, signal_shapes, simulate
    from eha_core.errors import EhaError, ParameterError, RecordingError
    from eha_core.plant import simulate_many
    from eha_core.recording.recording import Recording
    from eha_core.report.results import Results
    from eha_core.studies import budget, curves, design_test, detect, steps

_HOMES = {
    "EhaError": "errors",
    "ParameterError": "errors",
    "Recording": "recording",
    "RecordingError": "errors",
    "Results": "report.results",
    "budget": "studies",
    "catalogue": "api",
    "curves": "studies",
    "design_test": "studies",
    "detect": "studies",
    "diagnose": "api",
    "read": "api",
    "signal_shapes": "api",
    "simulate": "api",
    "simulate_many": "plant",
    "steps": "studies",
}

__all__ = [
    "EhaError",
    "ParameterError",
    "Recording",
    "RecordingError",
    "Results",
    "__version__",
    "budget",
    "catalogue",
    "curves",
    "design_test",
    "detect",
    "diagnose",
    "read",
    "signal_shapes",
    "simulate",
    "simulate_many",
    "steps",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
