"""Axes whose grid and labels are drawn at once look as matplotlib's own do."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from eha_core.report.plain_axes import FRAME, GRID, LABEL_SIZE, TEXT, TICK_SIZE, plain_axes, set_ticks

BOX = (0.2, 0.25, 0.7, 0.65)
DPI = 100


def image(figure: Figure) -> np.ndarray:
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3].astype(int)


def filled(axes, kind: str) -> None:
    x = np.linspace(-0.31, 0.94, 200)
    axes.plot(x, {"small": 3e-7, "plain": 40.0}.get(kind, 1.0) * np.sin(9.0 * x), color="k")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("pressure [MPa]")
    if kind == "named":
        set_ticks(axes.yaxis, [-0.5, 0.0, 0.5], ["one", "two +\nlines", "glyphs"])


def drawn_by_matplotlib(kind: str) -> np.ndarray:
    """The same look, set by matplotlib's own means."""
    figure = Figure(figsize=(5.0, 3.0), dpi=DPI)
    with matplotlib.rc_context({"xtick.labelsize": TICK_SIZE, "ytick.labelsize": TICK_SIZE}):
        axes = figure.add_axes(BOX)
        axes.grid(color=GRID)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
        axes.spines[["left", "bottom"]].set_color(FRAME)
        axes.tick_params(colors=TEXT, length=0)
        filled(axes, kind)
        for label in (axes.xaxis.label, axes.yaxis.label):
            label.set(color=TEXT, size=LABEL_SIZE)
        for axis in (axes.xaxis, axes.yaxis):
            axis.get_offset_text().set(color=TEXT)
        return image(figure)


def drawn_plainly(kind: str, **options: bool) -> np.ndarray:
    figure = Figure(figsize=(5.0, 3.0), dpi=DPI)
    filled(plain_axes(figure, BOX, **options), kind)
    return image(figure)


def moved(first: np.ndarray, other: np.ndarray) -> float:
    """The share of pixels that differ clearly from all pixels next to their place in the other image."""
    shifts = [np.roll(other, (up, right), (0, 1)) for up in (-1, 0, 1) for right in (-1, 0, 1)]
    least = np.min([np.abs(first - one).max(axis=2) for one in shifts], axis=0)
    return float(np.mean(least > 40))


@pytest.mark.parametrize("kind", ["plain", "small", "named"])
def test_they_look_as_matplotlib_s_own(kind: str) -> None:
    own, plain = drawn_by_matplotlib(kind), drawn_plainly(kind)
    assert moved(own, plain) < 5e-4
    assert moved(plain, own) < 5e-4


def test_without_labels_below_and_without_a_grid() -> None:
    whole, bare = drawn_plainly("plain"), drawn_plainly("plain", labelled=False, grid=False)
    below = round(0.76 * len(whole))
    assert np.any(whole[below:] < 200)
    assert np.all(bare[below + 1 :] == 255)
    grid = np.array([int(GRID[place : place + 2], 16) for place in (1, 3, 5)])
    counts = [np.count_nonzero(np.all(one == grid, axis=2)) for one in (whole, bare)]
    assert counts[0] > 1000
    assert counts[1] < 10


def test_they_share_the_horizontal_axis() -> None:
    figure = Figure()
    above = plain_axes(figure, (0.1, 0.6, 0.8, 0.3))
    beneath = plain_axes(figure, (0.1, 0.1, 0.8, 0.3), above)
    above.set_xlim(2.0, 3.0)
    assert beneath.get_xlim() == (2.0, 3.0)
