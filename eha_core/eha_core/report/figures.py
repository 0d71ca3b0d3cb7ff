"""Draws the same pictures with matplotlib, as PNG files."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from io import BytesIO
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from eha_core.report.picture import (
    COLOURS,
    NOISE_SHADE,
    SHADE,
    TRANSLUCENT,
    Band,
    Bars,
    Cells,
    Dots,
    Intervals,
    Line,
    Mark,
    Panel,
    Picture,
    Ribbon,
    Spans,
    Upright,
)

RESOLUTION = 120
"""Pixels an inch in the files."""

SHOWN = 75
"""Pixels an inch in a notebook."""

PIXELS_PER_INCH = 100.0
WIDTH = 11.0
GAP = 62
"""Pixels for a panel's title and labels."""
LEGEND_ROW = 0.3  # inches


class Drawn(Figure):
    """A figure that a notebook shows, whatever plotting backend it has."""

    def _repr_png_(self) -> bytes:
        stream = BytesIO()
        self.savefig(stream, dpi=SHOWN, format="png")
        return stream.getvalue()


def write_figures(pictures: Iterable[Picture], folder: Path) -> tuple[Path, ...]:
    """Draw every picture into `folder`, one file each, named after it."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for picture in pictures:
        path = folder / f"{picture.name}.png"
        drawn(picture).savefig(path, dpi=RESOLUTION)
        written.append(path)
    return tuple(written)


def drawn(picture: Picture) -> Drawn:
    """The picture as a figure."""
    columns = len(picture.columns)
    rows = [picture.groups[start : start + columns] for start in range(0, len(picture.groups), columns)]
    heights = [max(sum(panel.height + GAP for panel in group.panels) for group in row) for row in rows]
    figure = Drawn(figsize=(WIDTH, (sum(heights) + 70) / PIXELS_PER_INCH), layout="constrained")
    grid = figure.add_gridspec(len(rows), columns, width_ratios=picture.columns, height_ratios=heights)
    for row, groups in enumerate(rows):
        for column, group in enumerate(groups):
            inner = grid[row, column].subgridspec(
                len(group.panels), 1, height_ratios=[one.height for one in group.panels]
            )
            shared: Any = None
            for place, panel in enumerate(group.panels):
                axes = figure.add_subplot(inner[place], sharex=shared)
                shared = shared or axes
                _draw(axes, panel, place == len(group.panels) - 1)
    if picture.title:
        figure.suptitle(picture.title, x=0.01, ha="left", fontsize=13, fontweight="bold", color=COLOURS["measured"])
    handles = [Patch(color=colour, label=label) for label, colour in picture.legend()]
    if handles:
        legend_below(figure, handles, "lower left", min(5, len(handles)), fontsize=9)
    return figure


def legend_below(figure: Figure, handles: Sequence[Any], place: str, columns: int, **options: Any) -> None:
    """Put a legend under everything that is in a figure: what Matplotlib before 3.7 has no `place` for."""
    height = LEGEND_ROW * math.ceil(len(handles) / columns) / figure.get_figheight()
    figure.set_layout_engine("constrained", rect=(0.0, height, 1.0, 1.0 - height))
    figure.legend(handles=handles, loc=place, ncols=columns, frameon=False, **options)


def _draw(axes: Any, panel: Panel, last: bool) -> None:
    axes.grid(color="#edf0f2")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color("#c9d1d7")
    axes.tick_params(colors="#5c6b78", labelsize=8, length=0, labelbottom=last)
    if panel.names:
        axes.set_yticks(range(len(panel.names)), [name.replace(" + ", " +\n") for name in panel.row_labels])
        axes.set_ylim(len(panel.names) - 0.4, -0.6)
    for mark in panel.marks:
        _mark(axes, mark)
    if panel.title:
        axes.set_title(panel.title, loc="left", fontsize=9.5, fontweight="bold", color=COLOURS["measured"])
    axes.set_xlabel(panel.x_label if last else "", fontsize=9, color="#5c6b78")
    axes.set_ylabel(panel.y_label, fontsize=9, color="#5c6b78")
    if panel.x_range:
        axes.set_xlim(*panel.x_range)
    if panel.y_range:
        axes.set_ylim(*panel.y_range)
    if panel.x_ticks:
        axes.set_xticks([place for place, _ in panel.x_ticks], [text for _, text in panel.x_ticks])


def _mark(axes: Any, mark: Mark) -> None:
    if isinstance(mark, Line):
        style = "--" if mark.dashed else "-"
        axes.plot(mark.x, mark.y, style, color=COLOURS[mark.role], linewidth=0.7 * mark.width)
    elif isinstance(mark, Ribbon):
        colour = COLOURS[mark.role]
        axes.fill_between(mark.x, mark.low, mark.high, color=colour, alpha=TRANSLUCENT, linewidth=0)
    elif isinstance(mark, Upright):
        axes.axvline(mark.x, color=COLOURS["measured"], linewidth=0.9, linestyle=":")
        axes.annotate(mark.label, (mark.x, 1.0), (3, -2), xycoords=("data", "axes fraction"),
                      textcoords="offset points", va="top", fontsize=8, color="#5c6b78")  # fmt: skip
    elif isinstance(mark, Dots):
        axes.plot(
            mark.x, mark.y, ".", color=COLOURS[mark.role], markersize=0.75 * mark.size, alpha=0.5, markeredgewidth=0
        )
    elif isinstance(mark, Band):
        axes.axhspan(mark.low, mark.high, color=NOISE_SHADE, linewidth=0)
    elif isinstance(mark, Spans):
        for start, end in mark.spans:
            axes.axvspan(start, end, color=SHADE, alpha=0.75, linewidth=0)
    elif isinstance(mark, Bars):
        _bars(axes, mark)
    elif isinstance(mark, Cells):
        _cells(axes, mark)
    else:
        _intervals(axes, mark)


def _bars(axes: Any, mark: Bars) -> None:
    axes.barh(np.arange(len(mark.x)), mark.x, height=0.58, color=[COLOURS[role] for role in mark.roles])
    axes.margins(x=0.15)
    for row, text in enumerate(mark.texts):
        axes.annotate(
            text, (max(0.0, float(mark.x[row])), row), (4, 0), textcoords="offset points", va="center", fontsize=8
        )


def _cells(axes: Any, mark: Cells) -> None:
    shades = LinearSegmentedColormap.from_list("cells", [COLOURS["before"], "#ffffff", COLOURS["after"]])
    shown = axes.imshow(mark.values, cmap=shades, vmin=mark.low, vmax=mark.high, aspect="auto")
    axes.grid(visible=False)
    axes.set_xticks(range(len(mark.names)), [str(place + 1) for place in range(len(mark.names))])
    axes.figure.colorbar(shown, ax=axes, shrink=0.6)


def _intervals(axes: Any, mark: Intervals) -> None:
    rows = enumerate(mark.roles)
    for role, members in groupby(sorted(rows, key=lambda one: one[1]), key=lambda one: one[1]):
        at = [row for row, _ in members]
        axes.errorbar(mark.x[at], at, xerr=mark.reach[at], fmt="o", color=COLOURS[role], capsize=3, markersize=5)
