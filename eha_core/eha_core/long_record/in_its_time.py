"""A diagnosis of stretches in the time of the record that they are from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from eha_core.diagnosis.result import Diagnosis, Location, NamedEffect, Pictures
from eha_core.recording import Recording

WHOLE = 0.9
"""Share of a stretch from which on a span is all of it (assumed)."""

Stretches = tuple[Path, float, Sequence[Recording], Sequence[tuple[float, float]]]
"""A record's path and duration [s], the recordings of its stretches, and when these begin and end in it [s]."""


def in_time_of_record(diagnosis: Diagnosis, records: Sequence[Stretches]) -> Diagnosis:
    """Where the stretch that the diagnosis draws is one of a record: its path, its length, its times."""
    for path, whole, recordings, spans in records:
        for recording, (start, _) in zip(recordings, spans, strict=True):
            if str(recording.path) == diagnosis.path:
                of_record = replace(
                    diagnosis,
                    path=str(path),
                    duration=whole,
                    start_stamp=recording.start_stamp - round(start * 1e9),
                )
                return _moved(of_record, start, recording.duration)
    return diagnosis


def _moved(diagnosis: Diagnosis, by: float, duration: float) -> Diagnosis:
    effects = tuple(_effect(effect, by) for effect in diagnosis.effects)
    summary = diagnosis.summary
    for old, new in zip(diagnosis.effects, effects, strict=True):
        summary = summary.replace(old.statement, new.statement)
    left = diagnosis.explained
    return replace(
        diagnosis,
        summary=summary,
        effects=effects,
        location=tuple(_location(location, by, duration) for location in diagnosis.location),
        explained=replace(left, left_over=tuple(_location(location, by, duration) for location in left.left_over)),
        pictures=_pictures(diagnosis.pictures, by, duration),
    )


def _effect(effect: NamedEffect, by: float) -> NamedEffect:
    if effect.active is None:
        return effect
    before, after = effect.active, (effect.active[0] + by, effect.active[1] + by)
    stated = f"from {before[0]:.4g} s to {before[1]:.4g} s"
    return replace(
        effect, active=after, statement=effect.statement.replace(stated, f"from {after[0]:.6g} s to {after[1]:.6g} s")
    )


def _location(location: Location, by: float, duration: float) -> Location:
    when = tuple((start + by, end + by) for start, end in location.when)
    whole = len(location.when) == 1 and location.when[0][1] - location.when[0][0] > WHOLE * duration
    return replace(location, when=when, all_of_stretch=whole)


def _pictures(pictures: Pictures, by: float, duration: float) -> Pictures:
    return replace(
        pictures,
        time={name: time + by for name, time in pictures.time.items()},
        variables={name: values + by if name == "time" else values for name, values in pictures.variables.items()},
        equations={name: (time + by, residual) for name, (time, residual) in pictures.equations.items()},
        held_out=tuple((start + by, end + by) for start, end in pictures.held_out),
        span=(by, by + duration),
    )
