"""A certificate of a planned test as a table, a JSON document and a figure."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from eha_core.detectability import NOISE, Certificate
from eha_core.diagnosis.result import Detectable, Noticeable
from eha_core.quantities import quantity, short
from eha_core.report.study_files import write_study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "eha.detect/1"

FULL_SCALES = {"m": "stroke", "A": "rated current", "N": "stall force", "Pa": "supply pressure"}
"""The full scale of which a size of each unit is a share."""

_WIDTH = 100
_NAME, _SIZE, _BESIDE, _LISTED = 38, 23, 28, 3


def document(certificate: Certificate) -> dict[str, Any]:
    """The certificate as plain JSON types, SI throughout."""
    test = certificate.test
    return {
        "schema": SCHEMA,
        "test": {"duration": test.duration, "rate": test.rate, "channels": list(test.channels),
                 "noise": {name: test.noise * NOISE[name] for name in test.channels},
                 "samples": certificate.samples, "stroke": certificate.stroke},
        "power": certificate.power,
        "effects": [detectable_row(row) for row in certificate.effects],
        "parameters": [noticeable_row(row) for row in certificate.parameters],
        "remarks": list(certificate.remarks),
    }  # fmt: skip


def detectable_row(row: Detectable) -> dict[str, Any]:
    """A smallest size as plain JSON types."""
    return {
        "id": row.effect, "parameter": row.parameter, "unit": row.unit, "size": row.size, "flow": row.flow,
        "with_pressures": row.with_pressures, "at": dict(row.shape), "share": row.share,
        "compensated_by": list(row.compensated_by),
        "not_distinguished_from": [{"id": other.effect, "left": other.left, "cosine": other.cosine}
                                   for other in row.confusions],
    }  # fmt: skip


def noticeable_row(row: Noticeable) -> dict[str, Any]:
    """A smallest change of a nominal parameter as plain JSON types."""
    return {"name": row.name, "nominal": row.nominal, "change": row.change, "unit": row.unit, "flow": row.flow}


def as_json(certificate: Certificate) -> str:
    """The document as text, ending with a newline."""
    return json.dumps(document(certificate), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def account(certificate: Certificate) -> str:
    """The certificate as text for the terminal."""
    more = any(row.with_pressures is not None for row in certificate.effects)
    lines = [*wrap(_test(certificate), _WIDTH), ""]
    head = f"{'smallest size found with 95 % probability':{_NAME + 2 + _SIZE}}"
    lines += [f"{head}{'of full scale, or leak flow':{_BESIDE}}{'with pressures' if more else ''}".rstrip()]
    for row in certificate.effects:
        lines.append(_line(row, certificate))
        lines += wrap(doubts(row), _WIDTH, initial_indent=" " * 6, subsequent_indent=" " * 6)
    lines += ["", "smallest change of a nominal parameter that is reported with 95 % probability"]
    lines += [f"  {row.name:{_NAME}}{quantity(row.change, row.unit):{_SIZE}}{_relative(row)}".rstrip()
              for row in certificate.parameters]  # fmt: skip
    lines += [f"Note: {remark}" for remark in certificate.remarks]
    return "\n".join(lines)


def _test(certificate: Certificate) -> str:
    test = certificate.test
    channels = " and ".join(f"{name.replace('_', ' ')} (noise {quantity(test.noise * NOISE[name], _unit(name))})"
                            for name in test.channels)  # fmt: skip
    return (
        f"{test.duration:g} s at {test.rate:g} Hz of {channels}; the piston goes through"
        f" {100.0 * certificate.stroke:.3g} % of its stroke"
    )


def _unit(channel: str) -> str:
    return "m" if channel == "position" else "Pa"


def _line(row: Detectable, certificate: Certificate) -> str:
    size = "not found" if row.size is None else quantity(row.size, row.unit)
    more = "" if row.with_pressures is None else quantity(row.with_pressures, row.unit)
    scale = certificate.scales.get(row.unit)
    beside = ""
    if row.flow:
        beside = quantity(row.flow, "m^3/s")
    elif row.size is not None and scale:
        beside = f"{100.0 * row.size / scale:.2g} % of {FULL_SCALES[row.unit]}"
    return f"  {f'{row.effect}, {row.parameter}':{_NAME}}{size:{_SIZE}}{beside:{_BESIDE}}{more}".rstrip()


def _relative(row: Noticeable) -> str:
    if row.flow:
        return quantity(row.flow, "m^3/s")
    return f"{short(100.0 * row.change / row.nominal)} %" if row.nominal else ""


def doubts(row: Detectable) -> str:
    """What an effect cannot be distinguished from, and what compensates for it."""
    found = []
    if row.confusions:
        listed = " or ".join(other.effect for other in row.confusions[:_LISTED])
        more = len(row.confusions) - _LISTED
        found.append(f"cannot be distinguished from {listed}{f' or {more} more' if more > 0 else ''}")
    if row.compensated_by:
        found.append(f"nearly compensated by {' and '.join(row.compensated_by)}")
    return "; ".join(found)


def write_certificate(certificate: Certificate, folder: Path) -> tuple[Path, ...]:
    """Write detect.json and detect.png into a folder, made when missing; return their paths.

    Raises EhaError where the folder cannot be written to.
    """
    return write_study(folder, "detect", as_json(certificate), picture(certificate))


def picture(certificate: Certificate) -> Figure:
    """Figure of each effect's smallest detectable size, divided by its usual size on a bench actuator."""
    from matplotlib.figure import Figure  # plotting loads slowly, and a table needs none

    from eha_core.report.picture import COLOURS

    rows = sorted(certificate.effects, key=lambda row: (_ratio(row, row.size) or 1e99, row.effect))
    figure = Figure(figsize=(10.0, 1.6 + 0.24 * len(rows)), layout="constrained")
    axes = figure.add_subplot()
    for place, row in enumerate(rows):
        for size, role, marker in ((row.with_pressures, "other", "|"), (row.size, _role(row), "o")):
            ratio = _ratio(row, size)
            if ratio is not None and size is not None:
                axes.plot(ratio, place, marker, color=COLOURS[role], markersize=9 if marker == "|" else 6)
                if marker == "o" or row.size is None:
                    axes.annotate(quantity(size, row.unit), (ratio, place), (8, 0), textcoords="offset points",
                                  va="center", fontsize=7.5)  # fmt: skip
        if row.size is None and row.with_pressures is None:
            axes.annotate("at no size", (1.0, place), va="center", ha="center", fontsize=7.5, color=COLOURS["before"])
    axes.set_xscale("log")
    axes.axvline(1.0, color=COLOURS["other"], linewidth=0.8)
    axes.set_yticks(range(len(rows)), [f"{row.effect}, {row.parameter}" for row in rows], fontsize=8)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.margins(x=0.12)
    axes.grid(True, axis="x", linewidth=0.3)
    axes.set_xlabel("smallest size found with 95 % probability, over a size usual on a bench actuator")
    figure.legend(handles=list(_legend(rows, COLOURS)), frameon=False, fontsize=8, loc="outside lower center", ncols=4)
    return figure


def _role(row: Detectable) -> str:
    return "before" if row.compensated_by else "calibrated" if row.confusions else "after"


def _ratio(row: Detectable, size: float | None) -> float | None:
    return size / row.typical if size and row.typical else None


def _legend(rows: list[Detectable], colours: dict[str, str]) -> Iterator[Any]:
    from matplotlib.lines import Line2D

    words = {"after": "by itself", "calibrated": "not distinguished from another effect",
             "before": "nearly compensated by nominal parameters"}  # fmt: skip
    for role, label in words.items():
        yield Line2D([], [], marker="o", linestyle="", color=colours[role], label=label)
    if any(row.with_pressures is not None for row in rows):
        yield Line2D([], [], marker="|", linestyle="", color=colours["other"], markersize=9, label="with pressures")
