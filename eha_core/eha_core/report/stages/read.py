"""Stage 1, read and align: what was recorded."""

from __future__ import annotations

from pathlib import Path

from eha_core.diagnosis.result import Diagnosis
from eha_core.quantities import quantity, scale_for
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.claims import judged, noise_floor
from eha_core.report.health import drawn_line, excluded, fault_lines
from eha_core.report.picture import Group, Line, Mark, Panel, Picture, Spans
from eha_core.report.series import DRAWN
from eha_core.report.stage import Stage, Table
from eha_core.report.wording import capital, channel_title, channels_listed, plain, sentence


def stage(diagnosis: Diagnosis) -> Stage:
    """The recorded channels, their noise and faults, and the equations that could not be examined."""
    used = channels_listed(_channels(diagnosis))
    sentences = [
        f"{Path(diagnosis.path).name} was read and its channels were put on one clock.",
        noise_floor(diagnosis),
    ]
    sentences += [sentence(plain(fault)) for fault in fault_lines(diagnosis)]
    if diagnosis.damaged:
        sentences.append(f"The file is damaged, and the diagnosis rests on what could be read: {diagnosis.damaged}.")
    sentences += [sentence(plain(f"Not examined: {note}")) for note in diagnosis.not_examined]
    sentences += [sentence(plain(remark)) for remark in diagnosis.remarks]
    return Stage(
        "read",
        "Read and align",
        f"{diagnosis.duration:.1f} s of {used}",
        tuple(sentences),
        (_picture(diagnosis),),
        (_table(diagnosis),),
    )


def _channels(diagnosis: Diagnosis) -> list[str]:
    """The channels that were used, inputs before outputs."""
    return sorted(diagnosis.pictures.measured, key=list(CHANNEL_KINDS).index)


def _picture(diagnosis: Diagnosis) -> Picture:
    pictures = diagnosis.pictures
    shaded = (Spans(pictures.held_out, "held-out data"),) if pictures.held_out else ()
    panels = []
    for name in _channels(diagnosis):
        scale = scale_for(CHANNEL_KINDS[name].unit, float(abs(pictures.measured[name]).max()))
        time, values = drawn_line(pictures.time[name], pictures.measured[name], excluded(diagnosis, name), DRAWN)
        marks: tuple[Mark, ...] = (*shaded, Line(time, values / scale.factor, "measured", "measured", 1.1))
        panels.append(Panel(marks, "time [s]", scale.unit, capital(channel_title(name)), 140))
    return Picture(
        "1-read",
        (Group(tuple(panels)),),
        caption="The recording; the models are fitted to the unshaded parts and evaluated on the shaded ones.",
    )


def _table(diagnosis: Diagnosis) -> Table:
    fits = judged(diagnosis)
    rows = []
    for name in _channels(diagnosis):
        values = diagnosis.pictures.measured[name]
        unit = CHANNEL_KINDS[name].unit
        noise = quantity(fits[name].noise, unit) if name in fits else "drives the model"
        extent = f"{quantity(float(values.min()), unit)} to {quantity(float(values.max()), unit)}"
        rows.append((channel_title(name), f"{len(values):,}", extent, noise))
    return Table(("channel", "samples", "range", "noise (standard deviation)"), tuple(rows), "Channels")
