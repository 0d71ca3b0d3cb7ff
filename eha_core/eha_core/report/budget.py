"""An error budget as a table for people, as a document for programs, and as a waterfall."""

from __future__ import annotations

import json
from math import floor, log10
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from eha_core.error_budget import Budget, Share
from eha_core.error_budget.rig import PARAMETERS
from eha_core.error_budget.shares import Figure as Value
from eha_core.quantities import Scale, quantity, scale_for, short
from eha_core.report.study_files import write_study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "eha.budget/1"

_WIDTH = 100
_MODELLED = "the rig as modelled"
_FOUND = "other parameter values"


def document(budget: Budget) -> dict[str, Any]:
    """The budget as plain JSON types; lengths in m, `reach` half of a 95 % interval."""
    task = budget.task
    return {
        "schema": SCHEMA,
        "source": budget.source,
        "task": {
            "controller": task.controller or None, "signal": task.signal.name,
            "parameters": {row.name: getattr(task.signal, row.name) for row in task.signal.parameters()},
            "duration": task.duration, "skip": task.skip, "rate": task.rate, "command_limit": task.command_limit,
        },
        "today": _value(budget.today),
        "modelled": _value(budget.modelled),
        "repaired": _value(budget.repaired),
        "shares": [{"name": row.name, "statement": row.statement, "repairable": row.repairable,
                    "share": _value(row.share), "gain": _value(row.gain)} for row in budget.shares],
        "order": [{"name": step.name, "rmse": _value(step.rmse)} for step in budget.order],
        "subsets": [{"departures": list(names), "rmse": rmse} for names, rmse in budget.subsets.items()],
        "remarks": list(budget.remarks),
    }  # fmt: skip


def as_json(budget: Budget) -> str:
    """The document as text, ending with a newline."""
    return json.dumps(document(budget), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _value(figure: Value) -> dict[str, float]:
    return {"value": figure.value, "reach": figure.reach}


def account(budget: Budget) -> str:
    """The budget as text for the terminal."""
    scale = scale_for("m", max(budget.today.value, budget.modelled.value))
    lines = [*wrap(f"{budget.source}: {_task(budget)}", _WIDTH), ""]
    lines += [f"RMSE of the tracking error [{scale.unit}]{'share':>24}{'gain of repair alone':>24}"]
    lines += [_row(_MODELLED, scale, budget.modelled)]
    lines += [_row(_name(row), scale, row.share, row.gain if row.repairable else None) for row in budget.shares]
    lines += [_row("today, the sum", scale, budget.today), "", "repairs, the largest gain first; RMSE after each"]
    lines += [_row(f"{k}. {_plain(step.name)}", scale, step.rmse) for k, step in enumerate(budget.order, 1)]
    lines += [""] if budget.remarks else []
    for remark in budget.remarks:
        lines += wrap(f"Note: {remark}", _WIDTH, subsequent_indent="  ")
    return "\n".join(lines)


def _task(budget: Budget) -> str:
    """The motion in words: "sine of position (amplitude 10 mm, frequency 1 Hz) under pid, counted from 1 s to 4 s"."""
    task = budget.task
    own = "m" if task.controller else "V"
    settings = ", ".join(
        f"{row.name.replace('_', ' ')} {quantity(value, row.unit.replace('same', own))}"
        for row in task.signal.parameters()
        if isinstance(value := getattr(task.signal, row.name), float) and value != 0.0
    )
    opened = "voltage, open loop, against the rig as modelled"
    drive = f"position under {task.controller}" if task.controller else opened
    return f"a {task.signal.name} ({settings}) of {drive}, counted from {task.skip:g} s to {task.duration:g} s"


def _row(name: str, scale: Scale, first: Value, second: Value | None = None) -> str:
    return f"  {name:30}{_shown(first, scale):>24}{_shown(second, scale) if second else '':>24}".rstrip()


def _shown(figure: Value, scale: Scale) -> str:
    """Value and half of the interval, with the digits that the interval justifies; three digits without one."""
    value, reach = figure.value / scale.factor, figure.reach / scale.factor
    if not reach > 0.0:
        return short(value)
    decimals = min(max(0, 1 - floor(log10(reach))), 6)
    return f"{value:.{decimals}f} ± {reach:.{decimals}f}"


def _name(row: Share) -> str:
    return _FOUND if row.name == PARAMETERS else _plain(row.name)


def _plain(name: str) -> str:
    return name.replace("_", " ")


def write_budget(budget: Budget, folder: Path) -> tuple[Path, ...]:
    """Write budget.json and budget.png into a folder, made when missing; return their paths.

    Raises EhaError where the folder cannot be written to.
    """
    return write_study(folder, "budget", as_json(budget), waterfall(budget))


def waterfall(budget: Budget) -> Figure:
    """Figure of today's RMSE, repair by repair, down to the repaired rig's; and each departure's share and gain."""
    from matplotlib.figure import Figure  # plotting loads slowly, and a table needs none

    from eha_core.report.picture import COLOURS

    scale = scale_for("m", max(budget.today.value, budget.modelled.value))
    rows = _steps(budget)
    figure = Figure(figsize=(11.0, 1.9 + 0.34 * (len(rows) + len(budget.shares))), layout="constrained")
    upper, lower = figure.subplots(2, 1, height_ratios=[len(rows) + 1, len(budget.shares) + 1])
    _draw_steps(upper, rows, scale, COLOURS)
    _draw_shares(lower, budget, scale, COLOURS)
    for axes in (upper, lower):
        axes.invert_yaxis()
        axes.grid(True, axis="x", linewidth=0.3)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _steps(budget: Budget) -> list[tuple[str, float, float, str]]:
    """Rows of the waterfall: name, begin and end [m], and the colour's role."""
    found = [("today", 0.0, budget.today.value, "before")]
    at = budget.today.value
    for step in budget.order:
        found.append((f"{_plain(step.name)} repaired", at, step.rmse.value, "calibrated"))
        at = step.rmse.value
    found.append(("the rig repaired", 0.0, at, "after"))
    if any(row.name == PARAMETERS for row in budget.shares):
        found.append((_FOUND, at, budget.modelled.value, "other"))
        found.append((_MODELLED, 0.0, budget.modelled.value, "after"))
    return found


def _draw_steps(axes: Any, rows: list[tuple[str, float, float, str]], scale: Scale, colours: dict[str, str]) -> None:
    for place, (_, begin, end, role) in enumerate(rows):
        axes.barh(place, (end - begin) / scale.factor, left=begin / scale.factor, height=0.62, color=colours[role])
        told = end if begin == 0.0 else end - begin
        text = f"{told / scale.factor:.4g}" if begin == 0.0 else f"{told / scale.factor:+.3g}".replace("-", "−")
        beside = {"textcoords": "offset points", "va": "center", "fontsize": 9}
        axes.annotate(text, (max(begin, end) / scale.factor, place), (4, 0), **beside)
        if place + 1 < len(rows):
            axes.plot([end / scale.factor] * 2, [place + 0.31, place + 0.69], color=colours["other"], linewidth=0.8)
    axes.set_xlim(0.0, 1.1 * max(max(begin, end) for _, begin, end, _ in rows) / scale.factor)
    axes.set_yticks(range(len(rows)), [name for name, *_ in rows])
    axes.set_xlabel(f"RMSE of the tracking error [{scale.unit}]")
    axes.set_title("From today's error to the repaired rig's, the fastest repair first", loc="left", fontsize=11)


def _draw_shares(axes: Any, budget: Budget, scale: Scale, colours: dict[str, str]) -> None:
    for place, row in enumerate(budget.shares):
        for shift, figure, role in ((-0.17, row.share, "before"), (0.17, row.gain, "calibrated")):
            if role == "calibrated" and not row.repairable:
                continue
            axes.barh(
                place + shift, figure.value / scale.factor, xerr=figure.reach / scale.factor, height=0.32,
                color=colours[role], error_kw={"capsize": 2, "elinewidth": 0.9},
                label={"before": "share of today's RMSE", "calibrated": "gain of this repair alone"}[role],
            )  # fmt: skip
    handles, labels = axes.get_legend_handles_labels()
    seen = dict(zip(labels, handles, strict=True))
    axes.legend(seen.values(), seen.keys(), frameon=False, fontsize=9, loc="lower right")
    axes.axvline(0.0, color=colours["other"], linewidth=0.8)
    axes.set_yticks(range(len(budget.shares)), [_name(row) for row in budget.shares])
    axes.set_xlabel(f"RMSE [{scale.unit}], with 95 % intervals")
