"""A diagnosis as the document that `diagnosis.json` holds, schema "eha.diagnosis/1"."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from typing import Any

import numpy as np

from eha_core.diagnosis.result import (
    ChannelFit,
    Diagnosis,
    Explained,
    FittedValue,
    Location,
    LongRecord,
    NamedEffect,
    PredictedRecording,
    Prediction,
    RecordingFit,
    Residual,
    TraceStep,
    Undetected,
)
from eha_core.health import Fault
from eha_core.report.detectability import detectable_row, noticeable_row
from eha_core.report.location import location_statement

SCHEMA = "eha.diagnosis/1"


def document(diagnosis: Diagnosis) -> dict[str, Any]:
    """The diagnosis as plain JSON types, SI throughout. A number that is not finite is unknown and becomes null."""
    plain: dict[str, Any] = _plain(
        {
            "schema": SCHEMA,
            "provenance": diagnosis.provenance,
            "recording": _recording(diagnosis),
            "health": [_fault(number, fault, len(diagnosis.together)) for number, fault in diagnosis.health],
            "verdict": diagnosis.verdict,
            "event": diagnosis.event,
            "scale": _row(diagnosis.scale, ("of", "factor", "std", "parameters")),
            "summary": diagnosis.summary,
            "location": [_location(location) for location in diagnosis.location],
            "parameters": _rows(
                diagnosis.parameters, ("name", "nominal", "fitted", "std", "unit", "changed", "note", "at_bound")
            ),
            "effects": [_effect(effect) for effect in diagnosis.effects],
            "plant": diagnosis.composition.names,
            "fitted_values": diagnosis.fitted_values,
            "alternatives": _rows(diagnosis.alternatives, ("effects", "evidence_gap")),
            "unknown": _row(diagnosis.unknown, ("site", "function_of", "expression", "r_squared", "samples")),
            "fit": {"training": _fits(diagnosis.training), "held_out": _fits(diagnosis.held_out)},
            "next_experiment": _row(
                diagnosis.next_experiment, ("statement", "separates", "reference", "record", "duration")
            ),
            "sets": _rows(diagnosis.sets, ("effects", "probability")),
            "trace": [_trace_step(step) for step in diagnosis.trace],
            "rivals": [{"effects": effects, "score": score} for effects, score in diagnosis.rivals],
            "whiteness": diagnosis.whiteness,
            "explained": _explained(diagnosis.explained),
            "prediction": _predictions(diagnosis.prediction),
            "recordings": [_together(recording) for recording in diagnosis.together],
            "tests": [_test(recording) for recording in diagnosis.tests],
            "steps": [{"added": step.added, **_residual(step.residual)} for step in diagnosis.steps],
            "without": {name: _residual(residual) for name, residual in diagnosis.without.items()},
            "correlation": _row(diagnosis.correlation, ("names", "matrix")),
            **_undetected(diagnosis.undetected),
            **_long_records(diagnosis.long_records),
        }
    )
    return plain


def as_json(diagnosis: Diagnosis) -> str:
    """The document as text, ending with a newline."""
    return json.dumps(document(diagnosis), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _recording(diagnosis: Diagnosis) -> dict[str, Any]:
    return {
        "path": diagnosis.path,
        "duration_s": diagnosis.duration,
        "channels": diagnosis.channels,
        "not_examined": diagnosis.not_examined,
        "remarks": diagnosis.remarks,
        "damaged": diagnosis.damaged,
    }


def _explained(explained: Explained) -> dict[str, Any]:
    row = _rows([explained], ("share", "times_noise", "complete"))[0]
    return {**row, "left_over": _rows(explained.left_over, ("site", "share", "where", "when"))}


def _together(recording: RecordingFit) -> dict[str, Any]:
    return {"path": recording.path, "own_values": recording.own_values, "held_out": _fits(recording.held_out)}


def _test(recording: PredictedRecording) -> dict[str, Any]:
    predicted = {model: _predictions(each) for model, each in recording.prediction.items()}
    return {"path": recording.path, "noise": recording.noise, "prediction": predicted}


def _trace_step(step: TraceStep) -> dict[str, Any]:
    return {"step": step.step, "set": step.effects, "chi2": step.chi2, "cpu_s": step.cpu_s}


def _fault(number: int, fault: Fault, recordings: int) -> dict[str, Any]:
    """A fault of a channel; with several recordings, also the recording's number."""
    row = {
        "channel": fault.channel, "fault": fault.fault, "from": fault.start, "to": fault.end, "seen": fault.seen,
        "remedy": fault.remedy, "excluded": fault.excludes,
    }  # fmt: skip
    return row if recordings == 0 else {**row, "recording": number}


def _rows(items: Iterable[Any], names: tuple[str, ...]) -> list[dict[str, Any]]:
    return [{name: getattr(item, name) for name in names} for item in items]


def _row(item: Any, names: tuple[str, ...]) -> dict[str, Any] | None:
    return None if item is None else _rows([item], names)[0]


def _location(location: Location) -> dict[str, Any]:
    row = _rows([location], ("site", "share", "where", "when"))[0]
    return {**row, "statement": location_statement(location)}


def _effect(effect: NamedEffect) -> dict[str, Any]:
    row = _rows([effect], ("id", "site", "kind", "equation", "evidence", "probability", "statement", "active"))[0]
    row["parameters"] = {name: _value(value) for name, value in effect.parameters.items()}
    return row


def _value(value: FittedValue) -> dict[str, Any]:
    """A fitted value; with its interval where the standard deviation gives none."""
    row = _rows([value], ("value", "std", "unit"))[0]
    return row if value.interval is None else {**row, "interval": value.interval}


def _predictions(channels: Mapping[str, Prediction]) -> dict[str, Any]:
    return {
        name: {
            "ahead": {f"{ahead:g}": rmse for ahead, rmse in prediction.ahead.items()},
            "free_running": prediction.free_running,
        }
        for name, prediction in channels.items()
    }


def _fits(fits: Mapping[str, ChannelFit]) -> dict[str, Any]:
    names = ("rmse_before", "rmse_calibrated", "rmse_after", "noise")
    return {channel: _row(fit, names) for channel, fit in fits.items()}


def _long_records(records: Sequence[LongRecord]) -> dict[str, Any]:
    """The long records of which only stretches were fitted; no key without any."""
    found = []
    for record in records:
        row = _rows([record], ("path", "stretches", "window", "passed_over", "departs", "statement"))[0]
        blocks = _rows(record.blocks, ("start", "end", "fitted", "before", "after"))
        found.append({**row, "duration_s": record.duration, "blocks": blocks})
    return {"long_records": found} if found else {}


def _undetected(found: Undetected | None) -> dict[str, Any]:
    """Smallest sizes by effect, those of an effect's further independent sizes with its first; null if not known."""
    if found is None:
        return {"detectable": None, "noticeable": None}
    sizes: dict[str, dict[str, Any]] = {}
    for row in found.effects:
        entry = {"power": found.power, **detectable_row(row)}
        if row.effect in sizes:
            sizes[row.effect].setdefault("further", []).append(entry)
        else:
            sizes[row.effect] = entry
    return {"detectable": sizes, "noticeable": [noticeable_row(row) for row in found.parameters]}


def _residual(residual: Residual) -> dict[str, Any]:
    return _rows([residual], ("times_noise", "overall"))[0]


def _plain(value: Any) -> Any:
    """Mappings, sequences and NumPy's scalars as JSON's own types."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [_plain(item) for item in value]
    return value
