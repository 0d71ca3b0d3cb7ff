"""Assembles the samples of channels: in order, in the model's units, on one time axis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from eha_core.errors import RecordingError, printable
from eha_core.recording.channel_kinds import CHANNEL_KINDS, FloatArray
from eha_core.recording.channel_rules import ChannelRule
from eha_core.recording.discovery import LEAKAGE_TOPIC
from eha_core.recording.raw import RawRecording
from eha_core.recording.samples import Samples, on_one_span, put_in_order
from eha_core.recording.units import in_model_units
from eha_core.recording.writer import PARAMETERS_RECORD

STANDARD_ATMOSPHERE = 101325.0
"""Subtracted from absolute pressures where the recording has no `atmospheric_pressure` [Pa]."""

PARTS = "plant."
"""Prefix of the stored parameters that name the actuator's parts."""


@dataclass(frozen=True)
class Channel:
    """One measured quantity.

    Attributes:
        name: a key of CHANNEL_KINDS.
        time: strictly increasing, relative to the recording's first stamp [s].
        values: finite samples, one for each time, in `unit`; pressures are gauge.
        unit: SI unit as text.
        topic: topic, or CSV column, that it came from.
        type: message type, or "csv".
        rule: how it was read from there; None where it is not from a file.
    """

    name: str
    time: FloatArray
    values: FloatArray
    unit: str
    topic: str
    type: str
    rule: ChannelRule | None = None


@dataclass(frozen=True)
class Assembled:
    """Channels on one time axis, with parameters and remarks.

    Attributes:
        path: where it was read from.
        channels: what was measured, by channel name, in the order of CHANNEL_KINDS.
        start_stamp: the first stamp of any channel [ns].
        duration: from the first to the last sample of any channel [s].
        parameters: the nominal parameters that the recorder stored, by name [SI]; may be empty.
        leakage_changes: (time [s], coefficient [m^3/(s Pa)]) of each message on `internal_leakage`.
        damaged: which part of a damaged file could be read; None where the file is sound.
        remarks: exclusions and corrections while reading, one line each.
        parts: the actuator's parts by kind, as a nominal file has them under `plant:`; may be empty.
    """

    path: Path
    channels: Mapping[str, Channel]
    start_stamp: int
    duration: float
    parameters: Mapping[str, float]
    leakage_changes: tuple[tuple[float, float], ...]
    damaged: str | None
    remarks: tuple[str, ...]
    parts: Mapping[str, str] = field(default_factory=dict)


def assembled(
    path: Path,
    samples: Mapping[str, Samples],
    rules: Mapping[str, ChannelRule],
    types: Mapping[str, str],
    raw: RawRecording,
    remarks: list[str],
) -> Assembled:
    """The samples of each channel: in order, in the model's units, on one time axis.

    Raises RecordingError where no channel has a usable sample.
    """
    parameters = _parameters(raw, remarks)
    atmosphere = parameters.get("atmospheric_pressure", STANDARD_ATMOSPHERE)
    ordered: dict[str, Samples] = {}
    for name in (name for name in CHANNEL_KINDS if name in samples):
        source = f"{name} ({rules[name].topic})"
        series, notes = put_in_order(samples[name])
        if not len(series.values):
            remarks.append(f"{source}: no values were recorded")
            continue
        ordered[name] = series
        remarks += [f"{source}: {note}" for note in notes]
    if ordered:
        ordered, span_remarks = on_one_span(ordered, samples, ("voltage_command",))
        remarks += span_remarks
    for name, series in ordered.items():
        source = f"{name} ({rules[name].topic})"
        ordered[name], notes = in_model_units(f"{path}: {source}", name, rules[name], series, atmosphere)
        remarks += [f"{source}: {note}" for note in notes]
    if not ordered:
        what_to_do = "map what there is to channels in a topics file, as `eha inspect` writes it"
        raise RecordingError(f"{path}: {_nothing_usable(raw, remarks)}; {what_to_do}")
    start = min(int(series.stamps[0]) for series in ordered.values())
    duration = (max(int(series.stamps[-1]) for series in ordered.values()) - start) / 1e9
    return Assembled(
        path=path,
        channels={name: _channel(name, series, start, rules[name], types[name]) for name, series in ordered.items()},
        start_stamp=start,
        duration=duration,
        parameters=parameters,
        parts=_parts(raw),
        leakage_changes=_changes(samples.get(LEAKAGE_TOPIC), start),
        damaged=printable(f"{'; '.join(raw.damage)}; what was read covers {duration:.4g} s") if raw.damage else None,
        remarks=tuple(printable(remark) for remark in remarks),
    )


def _channel(name: str, series: Samples, start: int, rule: ChannelRule, type_name: str) -> Channel:
    time, values = (series.stamps - start) / 1e9, series.values
    time.flags.writeable = values.flags.writeable = False
    return Channel(name, time, values, CHANNEL_KINDS[name].unit, str(rule.topic), type_name, rule)


def _parameters(raw: RawRecording, remarks: list[str]) -> dict[str, float]:
    parameters = {}
    for name, text in raw.metadata.get(PARAMETERS_RECORD, {}).items():
        if name.startswith(PARTS):
            continue
        try:
            parameters[name] = float(text)
        except ValueError:
            remarks.append(f"the stored parameter {name} is not a number ({text!r}) and was left out")
    return parameters


def _parts(raw: RawRecording) -> dict[str, str]:
    """The actuator's parts that the recorder stored, by kind."""
    stored = raw.metadata.get(PARAMETERS_RECORD, {})
    return {name.removeprefix(PARTS): part for name, part in stored.items() if name.startswith(PARTS)}


def _changes(samples: Samples | None, start: int) -> tuple[tuple[float, float], ...]:
    if samples is None:
        return ()
    pairs = zip(((samples.stamps - start) / 1e9).tolist(), samples.values.tolist(), strict=True)
    return tuple(sorted((time, value) for time, value in pairs if np.isfinite(value)))


def _nothing_usable(raw: RawRecording, remarks: list[str]) -> str:
    if raw.damage and not raw.topics:
        return f"nothing could be saved ({'; '.join(raw.damage)})"
    recorded = ", ".join(f"{topic.name} ({topic.type_name})" for topic in raw.topics.values())
    because = f" ({'; '.join(remarks)})" if remarks else ""
    return f"no usable channel{because}; recorded topics: {recorded or 'none'}"
