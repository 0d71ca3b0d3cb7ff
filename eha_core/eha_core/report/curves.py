"""Steady curves of a valve as an account for people, as a document for programs, and as a picture."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from eha_core.quantities import quantity, scale_for, with_deviation
from eha_core.report.study_files import write_study
from eha_core.rig.measured_curves import SCHEMA
from eha_core.valve_curves import FLOW, LEAKAGE, PRESSURE, CurveFit, Found, Value, ValveCurves

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_WIDTH = 100
_NULL = {FLOW: "zero flow", PRESSURE: "zero load pressure", LEAKAGE: "largest leakage"}
_AXES = {FLOW: "flow", PRESSURE: "load pressure", LEAKAGE: "leakage"}
_COMMANDS = {"A": "current", "V": "voltage", "%": "command"}
_LABELS = {
    "flow_gain_positive": "flow gain, positive commands",
    "flow_gain_negative": "flow gain, negative commands",
    "asymmetry": "lower gain of negative commands",
    "hysteresis": "hysteresis, width of the loop",
    "edge_rounding": "rounding of the dead zone's edges",
    "curvature": "bend of the flow",
    "saturation_positive": "flow saturates, positive, at",
    "saturation_negative": "flow saturates, negative, at",
    "linearity_error": "linearity error of the largest flow",
    "noise": "scatter of the points",
    "pressure_gain": "pressure gain",
    "pressure_gain_share": "relative pressure gain",
    "largest_load_pressure": "largest load pressure",
    "null_leakage": "largest leakage",
    "leakage_far_from_null": "leakage far from null",
}


def document(curves: ValveCurves) -> dict[str, Any]:
    """The curves as plain JSON types; SI units and %, `reach` half of a 95 % interval."""
    return {
        "schema": SCHEMA,
        "conditions": asdict(curves.conditions),
        "curves": [
            {"source": fit.curve.source, "kind": fit.curve.kind, "command_unit": fit.curve.unit,
             "points": fit.curve.command.size,
             "values": [{"name": row.name, "value": row.value, "reach": row.reach, "unit": row.unit}
                        for row in fit.values.values()],
             "remarks": list(fit.remarks)}
            for fit in curves.fits
        ],
        "parameters": [{"name": row.name, "value": row.value, "reach": row.reach, "unit": row.unit, "how": row.how,
                        "sure": row.is_sure} for row in curves.parameters],
        "left_out": [{"name": name, "reason": reason} for name, reason in curves.left_out.items()],
    }  # fmt: skip


def as_json(curves: ValveCurves) -> str:
    """The document as text, ending with a newline."""
    return json.dumps(document(curves), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def account(curves: ValveCurves) -> str:
    """The curves as text for the terminal."""
    lines: list[str] = []
    for fit in curves.fits:
        lines += [*wrap(_heading(fit), _WIDTH), *(_row(fit, value) for value in fit.values.values())]
        for remark in fit.remarks:
            lines += wrap(f"  Note: {remark}", _WIDTH, subsequent_indent="    ")
        lines.append("")
    lines.append("Parameters of the plant (95 %)")
    lines += [_parameter(found) for found in curves.parameters] or ["  none follows"]
    reasons: dict[str, list[str]] = {}
    for name, reason in curves.left_out.items():
        reasons.setdefault(reason, []).append(name)
    for reason, names in reasons.items():
        lines += wrap(f"  not found: {', '.join(names)}: {reason}", _WIDTH, subsequent_indent="    ")
    return "\n".join(lines)


def _heading(fit: CurveFit) -> str:
    curve = fit.curve
    scale = scale_for(curve.unit, float(np.max(np.abs(curve.command))))
    low, high = curve.command.min() / scale.factor, curve.command.max() / scale.factor
    return f"{curve.source}: {curve.kind} curve, {curve.command.size} points from {low:.4g} to {high:.4g} {scale.unit}"


def _row(fit: CurveFit, value: Value) -> str:
    label, shown = _label(fit, value), _shown(value)
    if value.unit == fit.curve.unit:
        share = 100.0 * value.value / float(np.max(np.abs(fit.curve.command)))
        shown += f"  ({share:.2f} % of the largest command)"
    return f"  {label:36}{shown}"


def _label(fit: CurveFit, value: Value) -> str:
    if value.name == "null_shift":
        return f"null shift ({_NULL[fit.curve.kind]})"
    if value.name == "overlap":
        if not value.is_sure:
            return "overlap (+), underlap (-), not sure"
        return "overlap, half of the dead zone" if value.value > 0.0 else "underlap, half of the open zone"
    return _LABELS[value.name]


def _shown(value: Value) -> str:
    size = abs(value.value) if value.name == "overlap" and value.is_sure else value.value
    if value.unit == "-":
        percent = with_deviation(100.0 * size, 100.0 * (value.reach or 0.0), "-")
        return f"{percent} %"
    return quantity(size, value.unit) if value.reach is None else with_deviation(size, value.reach, value.unit)


def _parameter(found: Found) -> str:
    shown = with_deviation(found.value, found.reach, found.unit)
    doubt = "" if found.is_sure else "  (none found: the interval includes zero)"
    return f"  {found.name:36}{shown}{doubt}"


def write_curves(curves: ValveCurves, folder: Path) -> tuple[Path, ...]:
    """Write curves.json and curves.png into a folder, made when missing; return their paths.

    Raises EhaError where the folder cannot be written to.
    """
    return write_study(folder, "curves", as_json(curves), picture(curves))


def picture(curves: ValveCurves) -> Figure:
    """Figure of each curve's points with the fitted lines, one panel for each curve."""
    from matplotlib.figure import Figure  # plotting loads slowly, and an account needs none

    figure = Figure(figsize=(9.0, 4.2 * len(curves.fits)), layout="constrained")
    panels = figure.subplots(len(curves.fits), 1, squeeze=False)[:, 0]
    for axes, fit in zip(panels, curves.fits, strict=True):
        _draw(axes, fit)
    return figure


def _draw(axes: Any, fit: CurveFit) -> None:
    from eha_core.report.picture import COLOURS

    curve = fit.curve
    across = scale_for(curve.unit, float(np.max(np.abs(curve.command))))
    up = scale_for("Pa" if curve.kind == PRESSURE else "m^3/s", float(np.max(np.abs(curve.response))))
    axes.plot(curve.command / across.factor, curve.response / up.factor, ".", color=COLOURS["measured"], markersize=3,
              label="measured")  # fmt: skip
    for (label, command, response), role in zip(fit.lines, ("before", "after"), strict=False):
        axes.plot(command / across.factor, response / up.factor, color=COLOURS[role], linewidth=1.1, label=label)
    axes.axhline(0.0, color=COLOURS["other"], linewidth=0.6)
    axes.axvline(0.0, color=COLOURS["other"], linewidth=0.6)
    axes.set_xlabel(f"{_COMMANDS[curve.unit]} [{across.unit}]")
    axes.set_ylabel(f"{_AXES[curve.kind]} [{up.unit}]")
    axes.set_title(f"{curve.source}: {curve.kind} curve", loc="left", fontsize=11)
    axes.grid(True, linewidth=0.3)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=9)
