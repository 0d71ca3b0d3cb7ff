"""Whether the channels of a recording are compatible with the plant's source of oil."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.plant import Composition
from eha_core.plausibility.command import LATEST_MOTION
from eha_core.plausibility.regression import explained_by
from eha_core.plausibility.signals import Signals, on_grid
from eha_core.recording import Recording

UNRELATED = 0.1
"""Share of a flow's variance that its valve must explain: by the valve's equation nearly all, whatever leaks."""

CERTAIN = 20.0
"""Smallest range of a position that moves, as a multiple of its usual change between two samples (assumed)."""

HOLDS = 0.1
"""Largest relative variation of a constant supply pressure (assumed)."""

STANDS_IN = (
    ("measured_flow", ("flow_a", "flow_b")),
    ("measured_pressures", ("pressure_a", "pressure_b")),
    ("measured_force", ("force",)),
)
"""Sources that need only channels measured at the cylinder, and these channels."""


@dataclass(frozen=True)
class Contradiction:
    """A channel that contradicts the plant's source, and a source that it is compatible with."""

    what: str
    source: str

    def __str__(self) -> str:
        return f"{self.what}: the rig differs in architecture from the model; put in the nominal file: `{self.line}`"

    @property
    def line(self) -> str:
        """The nominal file's line that names the source."""
        return f"plant: {{source: {self.source}}}"


def contradiction(recording: Recording, composition: Composition) -> Contradiction | None:
    """The channel that contradicts the plant's source; None without one.

    It is a pump's speed, if the source is a valve between a constant supply and a tank; or a flow (without a recorded
    one, the piston's motion) to which the valve's signal is unrelated.
    """
    source, channels = composition.source, recording.channels
    if not source.valve:
        return None
    if "pump_speed" in channels and not _supply_holds(recording):
        return Contradiction(
            f"pump_speed was recorded, and plant.source = {source.id} is fed by a constant supply and has no pump",
            "switched_pump",
        )
    instead = next((name for name, needs in STANDS_IN if set(needs) <= channels.keys()), None)
    signals = on_grid(recording)
    if instead is None or signals is None or not _moves(recording):
        return None
    for name in ("spool", *source.inputs):
        if name in channels and (moved := _moves_without(signals, name)):
            value = f"{name} of plant.source = {source.id}"
            return Contradiction(f"{moved} while {value} {_what_it_does(signals, name)}", instead)
    return None


def _supply_holds(recording: Recording) -> bool:
    """Whether a constant supply pressure was recorded: then a pump's speed says nothing about the flow."""
    supply = recording.channels.get("supply_pressure")
    return supply is not None and bool(np.std(supply.values) < HOLDS * abs(float(np.mean(supply.values))))


def _moves(recording: Recording) -> bool:
    """Whether the piston moves by more than its sensor's noise."""
    values = recording.channels["position"].values
    return bool(np.ptp(values) > CERTAIN * np.median(np.abs(np.diff(values))))


def _moves_without(signals: Signals, name: str) -> str:
    """What moves although the valve's signal is unrelated to it; "" where nothing does.

    Without a recorded flow only a signal that never changes is reported: another may be of another run.
    """
    flow = next((channel for channel in ("flow_a", "flow_b") if channel in signals.channels), None)
    if flow is None:
        if np.ptp(signals.channels[name]) > 0.0:
            return ""
        pressures = all(channel in signals.channels for channel in ("pressure_a", "pressure_b"))
        return "pressure_a and pressure_b change and the piston moves" if pressures else "the piston moves"
    if not np.ptp(signals.channels[flow]) > 0.0:
        return ""
    delays = range(0, round(LATEST_MOTION / signals.step) + 1, max(1, round(0.01 / signals.step)))
    values, signal = signals.channels[flow], signals.channels[name]
    share = max(explained_by(values[delay:], signal[: len(signal) - delay]) for delay in delays)
    return f"{flow} changes" if share < UNRELATED else ""


def _what_it_does(signals: Signals, name: str) -> str:
    return "is unrelated to it" if np.ptp(signals.channels[name]) > 0.0 else "is constant"
