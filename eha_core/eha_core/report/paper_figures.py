"""Figures 3 to 5 of the paper, from a simulation or from a recording of the experiment, as PNG and SVG."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eha_core.paper.level import Level, Sweep
from eha_core.report.figures import legend_below

LEAKAGE = "$K_\\mathrm{Lin}$"
LEAKAGE_UNIT = "m³/(s Pa)"
COLOURS = ("#0072b2", "#009e73", "#e69f00", "#d55e00")
REFERENCE_COLOUR = "#555555"


def draw_paper_figures(levels: Sequence[Level], folder: Path, sweep: Sweep | None = None) -> list[Path]:
    """Write the three figures into a folder, made when missing, and return the files' paths."""
    folder.mkdir(parents=True, exist_ok=True)
    figures = {
        "figure_3_displacement": displacement_figure(levels),
        "figure_4_error": error_figure(levels),
        "figure_5_rmse": rmse_figure(levels, sweep),
    }
    written = []
    for name, figure in figures.items():
        for ending in ("png", "svg"):
            path = folder / f"{name}.{ending}"
            # Without a date and with a fixed salt the same result gives the same bytes.
            with matplotlib.rc_context({"svg.hashsalt": name}):
                figure.savefig(path, dpi=150, metadata={"Date": None} if ending == "svg" else None)
            written.append(path)
    return written


def displacement_figure(levels: Sequence[Level]) -> Figure:
    """Figure 3: displacement against time at the four levels, over the leakage-free one."""
    figure, panels = _panels("Figure 3: piston displacement under internal leakage")
    for axes, level, colour in zip(panels, levels, COLOURS, strict=True):
        axes.plot(level.time, level.reference * 1e3, color=REFERENCE_COLOUR, linewidth=1.0, label="without leakage")
        axes.plot(level.time, level.displacement * 1e3, color=colour, dashes=(4, 2), label="with leakage")
        axes.set_title(_title(level), fontsize=10)
        axes.set_ylabel("displacement [mm]")
    lowest = min(axes.get_ylim()[0] for axes in panels)
    highest = max(axes.get_ylim()[1] for axes in panels)
    for axes in panels:
        axes.set_ylim(lowest, highest)
    legend_below(figure, panels[-1].get_legend_handles_labels()[0], "lower center", 2)
    return figure


def error_figure(levels: Sequence[Level]) -> Figure:
    """Figure 4: error against time at the four levels, each on its own scale."""
    figure, panels = _panels("Figure 4: displacement error, with leakage minus without")
    for axes, level, colour in zip(panels, levels, COLOURS, strict=True):
        axes.plot(level.time, level.error * 1e3, color=colour, linewidth=1.2)
        axes.set_title(f"{_title(level)}, RMSE {level.rmse * 1e3:.4f} mm", fontsize=10)
        axes.set_ylabel("error [mm]")
    return figure


def rmse_figure(levels: Sequence[Level], sweep: Sweep | None = None) -> Figure:
    """Figure 5: RMSE against internal leakage, as computed, as printed and by the closed form."""
    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    axes = figure.add_subplot()
    leakages = [level.internal_leakage for level in levels]
    if sweep is not None:
        axes.plot(sweep.internal_leakage, sweep.rmse * 1e3, color=COLOURS[0], linewidth=1.2, label="computed")
        axes.plot(
            sweep.internal_leakage,
            sweep.closed_form * 1e3,
            color=REFERENCE_COLOUR,
            linewidth=1.0,
            linestyle="--",
            label="closed form k/(1+k) · RMS",
        )
    axes.plot(
        leakages,
        [level.rmse * 1e3 for level in levels],
        "o",
        color=COLOURS[0],
        label="computed, levels 1 to 4",
    )
    axes.plot(
        leakages,
        [level.printed * 1e3 for level in levels],
        "x",
        color=COLOURS[3],
        markersize=9,
        markeredgewidth=1.8,
        label="printed in Table 3",
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(f"internal leakage {LEAKAGE} [{LEAKAGE_UNIT}]")
    axes.set_ylabel("RMSE [mm]")
    axes.set_title("Figure 5: RMSE of the displacement over internal leakage", fontsize=11)
    axes.grid(True, which="both", linewidth=0.3)
    axes.legend(frameon=False)
    return figure


def _panels(title: str) -> tuple[Figure, list[Axes]]:
    """Return a figure of two by two panels over one time axis."""
    figure = Figure(figsize=(9.0, 5.6), layout="constrained")
    panels = list(figure.subplots(2, 2, sharex=True).flat)
    figure.suptitle(title, fontsize=11)
    for axes in panels:
        axes.grid(True, linewidth=0.3)
        axes.margins(x=0.0)
        axes.ticklabel_format(useOffset=False)
    for axes in panels[2:]:
        axes.set_xlabel("time [s]")
    return figure, panels


def _title(level: Level) -> str:
    mantissa, exponent = f"{level.internal_leakage:.0e}".split("e")
    factor = "" if mantissa == "1" else f"{mantissa} \\cdot "
    return f"{LEAKAGE} = ${factor}10^{{{int(exponent)}}}$ {LEAKAGE_UNIT}"
