"""Axes for many small panels: matplotlib's own, but their grid and labels are drawn at once.

Matplotlib keeps four artists for every tick and lays out each label as a paragraph, which takes most of the time of a
figure. Here the axes still find their limits, ticks and texts by matplotlib's rules; one artist draws them.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path
from matplotlib.ticker import FixedFormatter, FixedLocator
from matplotlib.transforms import IdentityTransform

GRID, FRAME, TEXT = "#edf0f2", "#c9d1d7", "#5c6b78"
LINE, PAD, LABEL_PAD = 0.8, 3.5, 4.0
"""Points: width of the grid and the frame, distance from the frame to the tick labels, from these to the axis label."""

TICK_SIZE, LABEL_SIZE = 8.0, 9.0
"""Font sizes [points]."""

LINE_SPACING = 1.2
"""Line spacing of a label, in heights of a letter."""


def plain_axes(
    figure: Figure, box: tuple[float, float, float, float], shared: Any = None, labelled: bool = True, grid: bool = True
) -> Any:
    """Axes of a figure.

    Args:
        box: left, bottom, width and height in parts of the figure.
        shared: axes whose horizontal axis these share.
        labelled: whether the horizontal axis has labels.
        grid: whether grid lines are drawn at each tick.
    """
    axes: Any = figure.add_axes(box, sharex=shared)
    axes.set_axis_off()
    axes.add_artist(Scales(labelled, grid))
    return axes


def set_ticks(axis: Any, places: Sequence[float], texts: Sequence[str]) -> None:
    """Put these texts at these places of an axis."""
    axis.set_major_locator(FixedLocator(places))
    axis.set_major_formatter(FixedFormatter(texts))


class Scales(Artist):
    """The grid, the left and the lower edge, and their labels; see `plain_axes`."""

    def __init__(self, labelled: bool, grid: bool) -> None:
        super().__init__()
        self._labelled, self._grid = labelled, grid
        self.set_zorder(0.5)  # behind everything

    def draw(self, renderer: Any) -> None:
        """Draw on a renderer."""
        axes: Any = self.axes
        box, pad = axes.bbox, renderer.points_to_pixels(PAD)
        # matplotlib chooses the number of ticks by the font size
        with matplotlib.rc_context({"xtick.labelsize": TICK_SIZE, "ytick.labelsize": TICK_SIZE}):
            (xs, across), (ys, up) = _ticks(axes.xaxis), _ticks(axes.yaxis)
        xs = axes.transData.transform([(x, axes.viewLim.y0) for x in xs])[:, 0] if len(xs) else xs
        ys = axes.transData.transform([(axes.viewLim.x0, y) for y in ys])[:, 1] if len(ys) else ys
        if self._grid:
            _lines(renderer, GRID, [((x, box.y0), (x, box.y1)) for x in xs] + [((box.x0, y), (box.x1, y)) for y in ys])
        _lines(renderer, FRAME, [((box.x0, box.y0), (box.x1, box.y0)), ((box.x0, box.y0), (box.x0, box.y1))])
        texts, ticks, labels = _Texts(renderer), _font(TICK_SIZE), _font(LABEL_SIZE)
        widest = max((texts.beside(box.x0 - pad, y, text, ticks) for y, text in zip(ys, up, strict=True)), default=0.0)
        if axes.get_ylabel():
            right = box.x0 - pad - widest - renderer.points_to_pixels(LABEL_PAD)
            texts.upright(right, 0.5 * (box.y0 + box.y1), axes.get_ylabel(), labels)
        texts.above(box.x0, box.y1 + pad, axes.yaxis.get_major_formatter().get_offset(), ticks)
        if self._labelled:
            heights = [texts.below(x, box.y0 - pad, text, ticks) for x, text in zip(xs, across, strict=True)]
            under = box.y0 - pad - max(heights, default=0.0) - renderer.points_to_pixels(LABEL_PAD)
            texts.below(0.5 * (box.x0 + box.x1), under, axes.get_xlabel(), labels)
            texts.below(box.x1, under, axes.xaxis.get_major_formatter().get_offset(), ticks)


def _ticks(axis: Any) -> tuple[Any, list[str]]:
    """The places of an axis' ticks within its limits, and their labels."""
    places = np.asarray(axis.get_majorticklocs(), dtype=np.float64)
    texts = axis.get_major_formatter().format_ticks(places)
    low, high = sorted(axis.get_view_interval())
    room = 1e-9 * (high - low)
    inside = (places >= low - room) & (places <= high + room)
    return places[inside], [text for text, kept in zip(texts, inside, strict=True) if kept]


@lru_cache
def _font(size: float) -> FontProperties:
    return FontProperties(size=size)


def _lines(renderer: Any, colour: str, lines: Sequence[tuple[tuple[float, float], tuple[float, float]]]) -> None:
    if not lines:
        return
    pen = renderer.new_gc()
    pen.set_foreground(colour)
    pen.set_linewidth(LINE)
    pen.set_snap(True)
    codes = np.tile(np.array([Path.MOVETO, Path.LINETO], dtype=np.uint8), len(lines))
    renderer.draw_path(pen, Path(np.reshape(lines, (-1, 2)), codes), IdentityTransform())
    pen.restore()


class _Texts:
    """Writes texts on a renderer where matplotlib would place those of its axes; each method returns the size taken."""

    def __init__(self, renderer: Any) -> None:
        self._renderer = renderer
        self._height = renderer.get_canvas_width_height()[1] if renderer.flipy() else 0.0
        self._pen = renderer.new_gc()
        self._pen.set_foreground(TEXT)
        self._lines: dict[int, tuple[float, float]] = {}

    def _size(self, text: str, font: FontProperties) -> tuple[float, float, float]:
        size: tuple[float, float, float] = self._renderer.get_text_width_height_descent(text, font, ismath=False)
        return size

    def _line(self, font: FontProperties) -> tuple[float, float]:
        """A line's height, and its descent below the baseline."""
        if id(font) not in self._lines:
            self._lines[id(font)] = self._size("lp", font)[1:]
        return self._lines[id(font)]

    def _write(self, x: float, y: float, text: str, font: FontProperties, angle: float = 0.0) -> None:
        self._renderer.draw_text(self._pen, x, abs(self._height - y), text, font, angle)

    def beside(self, right: float, middle: float, text: str, font: FontProperties) -> float:
        """Lines that end at `right`, centred at `middle`; returns the largest width."""
        height, descent = self._line(font)
        lines, widest = text.split("\n"), 0.0
        y = middle - 0.5 * (height - descent) + 0.5 * LINE_SPACING * height * (len(lines) - 1)
        for line in lines:
            width = self._size(line, font)[0]
            self._write(right - width, y, line, font)
            widest, y = max(widest, width), y - LINE_SPACING * height
        return widest

    def below(self, centre: float, top: float, text: str, font: FontProperties) -> float:
        """A text below `top`; returns its height."""
        if not text:
            return 0.0
        height, descent = self._line(font)
        self._write(centre - 0.5 * self._size(text, font)[0], top - height + descent, text, font)
        return height

    def above(self, left: float, bottom: float, text: str, font: FontProperties) -> None:
        """A text above `bottom`."""
        if text:
            self._write(left, bottom + self._line(font)[1], text, font)

    def upright(self, right: float, centre: float, text: str, font: FontProperties) -> None:
        """A text that runs upwards and ends left of `right`."""
        descent = self._line(font)[1]
        self._write(right - descent, centre - 0.5 * self._size(text, font)[0], text, font, 90.0)
