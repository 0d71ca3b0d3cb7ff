"""Draws the report's pictures with matplotlib, as PNG files."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from io import BytesIO
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from PIL import Image

from eha_core.report.picture import (
    COLOURS,
    NOISE_SHADE,
    SHADE,
    TRANSLUCENT,
    Band,
    Bars,
    Cells,
    Dots,
    Group,
    Intervals,
    Line,
    Mark,
    Panel,
    Picture,
    Ribbon,
    Spans,
    Upright,
)
from eha_core.report.plain_axes import plain_axes, set_ticks

RESOLUTION = 120
"""Pixels an inch in the files."""

SHOWN = 75
"""Pixels an inch in a notebook."""

PIXELS_PER_INCH = 100.0
WIDTH = 1100.0
LEFT, RIGHT, AXIS, TITLE, PANEL_TITLE, UNTITLED, LEGEND_ROW = 66.0, 14.0, 52.0, 40.0, 30.0, 14.0, 30.0
"""Pixels left and right of a panel, below a group, above a picture, above a panel with and without a title, and of a
row of the legend."""

CHARACTER = 6.6
"""Width of a letter of a row's label [pixels]."""

LEGEND_COLUMNS = 5


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
        figure = drawn(picture)
        figure.set_dpi(RESOLUTION)
        # savefig would draw everything twice; nothing is translucent, and three colour channels with weak compression
        # take half the time and fewer bytes than four with a stronger one
        canvas: Any = FigureCanvasAgg(figure)
        canvas.draw()
        colours = Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())
        colours.save(path, dpi=(RESOLUTION, RESOLUTION), compress_level=1)
        written.append(path)
    return tuple(written)


def drawn(picture: Picture) -> Drawn:
    """The picture as a figure.

    Panels have the page's own sizes, so their places are known beforehand: fitting them to their labels would take
    longer than drawing them.
    """
    columns = len(picture.columns)
    rows = [picture.groups[start : start + columns] for start in range(0, len(picture.groups), columns)]
    handles = [Patch(color=colour, label=label) for label, colour in picture.legend()]
    legend = LEGEND_ROW * math.ceil(len(handles) / LEGEND_COLUMNS)
    title = TITLE if picture.title else 0.0
    height = title + sum(max(map(_height, row)) for row in rows) + legend
    figure = Drawn(figsize=(WIDTH / PIXELS_PER_INCH, height / PIXELS_PER_INCH))
    widths = np.array(picture.columns) / sum(picture.columns) * WIDTH
    lefts = [max(_left(row[column]) for row in rows if column < len(row)) for column in range(len(rows[0]))]
    ceiling = height - title
    for row in rows:
        for column, group in enumerate(row):
            left = float(widths[:column].sum()) + lefts[column]
            _group(figure, group, left, float(widths[: column + 1].sum()) - RIGHT, ceiling, height)
        ceiling -= max(map(_height, row))
    if picture.title:
        place = 1.0 - 0.4 * TITLE / height
        figure.text(0.01, place, picture.title, va="center", fontsize=13, fontweight="bold", color=COLOURS["measured"])
    if handles:
        columns = min(LEGEND_COLUMNS, len(handles))
        figure.legend(handles=handles, loc="lower left", ncols=columns, frameon=False, fontsize=9)
    return figure


def _group(figure: Figure, group: Group, left: float, right: float, ceiling: float, height: float) -> None:
    """Draw the panels of a group below each other, between `left` and `right` and below `ceiling` [pixels]."""
    shared: Any = None
    for place, panel in enumerate(group.panels):
        bottom = ceiling - _above(panel) - panel.height
        box = (left / WIDTH, bottom / height, (right - left) / WIDTH, panel.height / height)
        grid = not any(isinstance(mark, Cells) for mark in panel.marks)
        axes = plain_axes(figure, box, shared, place == len(group.panels) - 1, grid)
        shared = shared or axes
        _draw(axes, panel)
        ceiling = bottom


def _above(panel: Panel) -> float:
    return PANEL_TITLE if panel.title else UNTITLED


def _height(group: Group) -> float:
    """A group's pixels with its titles and its axis."""
    return sum(_above(panel) + panel.height for panel in group.panels) + AXIS


def _left(group: Group) -> float:
    """Width of the labels left of a group's panels [pixels]."""
    labels = [lines for panel in group.panels for lines in panel.row_labels]
    longest = max((len(line) for lines in labels for line in lines), default=0)
    return LEFT + (CHARACTER * longest - LEFT / 2.0 if longest else 0.0)


def legend_below(figure: Figure, handles: Sequence[Any], place: str, columns: int, **options: Any) -> None:
    """Put a legend below everything in a figure; Matplotlib before 3.7 has no location for that."""
    height = LEGEND_ROW / PIXELS_PER_INCH * math.ceil(len(handles) / columns) / figure.get_figheight()
    figure.set_layout_engine("constrained", rect=(0.0, height, 1.0, 1.0 - height))
    figure.legend(handles=handles, loc=place, ncols=columns, frameon=False, **options)


def _draw(axes: Any, panel: Panel) -> None:
    if panel.names:
        set_ticks(axes.yaxis, range(len(panel.names)), ["\n".join(lines) for lines in panel.row_labels])
        axes.set_ylim(len(panel.names) - 0.4, -0.6)
    for mark in panel.marks:
        _mark(axes, mark)
    # at a fixed height: without one, Matplotlib measures every label
    axes.set_title(panel.title, loc="left", y=1.0, fontsize=9.5, fontweight="bold", color=COLOURS["measured"])
    axes.set_xlabel(panel.x_label)
    axes.set_ylabel(panel.y_label)
    if panel.x_range:
        axes.set_xlim(*panel.x_range)
    if panel.y_range:
        axes.set_ylim(*panel.y_range)
    if panel.x_ticks:
        set_ticks(axes.xaxis, [place for place, _ in panel.x_ticks], [text for _, text in panel.x_ticks])


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
    set_ticks(axes.xaxis, range(len(mark.names)), [str(place + 1) for place in range(len(mark.names))])
    axes.figure.colorbar(shown, ax=axes, shrink=0.6)


def _intervals(axes: Any, mark: Intervals) -> None:
    rows = enumerate(mark.roles)
    for role, members in groupby(sorted(rows, key=lambda item: item[1]), key=lambda item: item[1]):
        at = [row for row, _ in members]
        axes.errorbar(mark.x[at], at, xerr=mark.reach[at], fmt="o", color=COLOURS[role], capsize=3, markersize=5)
