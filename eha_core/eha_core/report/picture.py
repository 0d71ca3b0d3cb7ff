"""The content of a picture, independent of how it is drawn: the page uses Plotly, the files matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import wrap

from eha_core.identification.numbers import Array

COLOURS = {
    "measured": "#22303c",
    "before": "#c4553b",
    "calibrated": "#d79a2b",
    "after": "#1d7a8c",
    "other": "#9aa7b2",
}
"""By role; they differ in lightness, so that they can be distinguished without colour vision."""

FEW_DOTS = 500

TRANSLUCENT = 0.22
"""Opacity of a ribbon."""

SHADE = "#e9e2d4"
NOISE_SHADE = "#d5dde3"

LABELS = {
    "measured": "measured",
    "before": "nominal model",
    "calibrated": "recalibrated",
    "after": "augmented",
    "other": "not decisive",
}


@dataclass(frozen=True)
class Line:
    """A curve; NaN breaks it."""

    x: Array
    y: Array
    role: str
    label: str = ""
    width: float = 1.4
    dashed: bool = False


@dataclass(frozen=True)
class Ribbon:
    """The area between two curves over one axis."""

    x: Array
    low: Array
    high: Array
    role: str
    label: str = ""


@dataclass(frozen=True)
class Upright:
    """A vertical line that divides the axis."""

    x: float
    label: str


@dataclass(frozen=True)
class Dots:
    """Points of a `diameter` [pixels]; without one, a few points are drawn larger than many."""

    x: Array
    y: Array
    role: str
    label: str = ""
    diameter: float = 0.0

    @property
    def size(self) -> float:
        """Their diameter in pixels."""
        return self.diameter or (3.5 if len(self.x) > FEW_DOTS else 6.0)


@dataclass(frozen=True)
class Intervals:
    """Values with intervals of half width `reach`, one a row, the first on top."""

    names: tuple[str, ...]
    x: Array
    reach: Array
    roles: tuple[str, ...]
    texts: tuple[str, ...]


@dataclass(frozen=True)
class Bars:
    """Horizontal bars, one a row, the first on top."""

    names: tuple[str, ...]
    x: Array
    roles: tuple[str, ...]
    texts: tuple[str, ...]


@dataclass(frozen=True)
class Cells:
    """A square table of numbers between `low` and `high`, each as a colour: from that of "before" over white to that of
    "after"; rows and columns have the same names."""

    names: tuple[str, ...]
    values: Array
    low: float
    high: float


@dataclass(frozen=True)
class Band:
    """A horizontal band between `low` and `high`, as of noise."""

    low: float
    high: float
    label: str


@dataclass(frozen=True)
class Spans:
    """Stretches of the horizontal axis."""

    spans: tuple[tuple[float, float], ...]
    label: str


LONGEST_LINE = 48
"""Letters of a line of a row's label: a third of a picture's width."""


def label_lines(label: str) -> tuple[str, ...]:
    """The lines of a row's label: an effect of a set begins a line, and none is longer than LONGEST_LINE."""
    parts = label.replace(" + ", " +\n").split("\n")
    return tuple(line for part in parts for line in (wrap(part, LONGEST_LINE) if len(part) > LONGEST_LINE else [part]))


Mark = Line | Dots | Ribbon | Upright | Intervals | Bars | Cells | Band | Spans


@dataclass(frozen=True)
class Panel:
    """One pair of axes; `height` in the page's pixels; ranges where not all should be visible at first.

    `x_ticks` are places with their labels, where the axis does not show plain numbers.
    """

    marks: tuple[Mark, ...]
    x_label: str = ""
    y_label: str = ""
    title: str = ""
    height: int = 190
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    x_ticks: tuple[tuple[float, str], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """The rows' names, where the panel has rows."""
        return next((mark.names for mark in self.marks if isinstance(mark, (Intervals, Bars, Cells))), ())

    @property
    def row_labels(self) -> tuple[tuple[str, ...], ...]:
        """The lines of each row's label: numbered where the columns have room for a number only."""
        numbered = any(isinstance(mark, Cells) for mark in self.marks)
        labels = (f"{name}  {place}" if numbered else name for place, name in enumerate(self.names, start=1))
        return tuple(map(label_lines, labels))


@dataclass(frozen=True)
class Group:
    """Panels above each other that share their horizontal axis."""

    panels: tuple[Panel, ...]


@dataclass(frozen=True)
class Picture:
    """Groups laid out in rows with columns of these relative widths; on narrow screens one below the other."""

    name: str
    groups: tuple[Group, ...]
    columns: tuple[int, ...] = (1,)
    title: str = ""
    caption: str = ""

    def legend(self) -> tuple[tuple[str, str], ...]:
        """(label, colour) of everything that has a label, each once."""
        found: dict[str, str] = {}
        for group in self.groups:
            for panel in group.panels:
                for mark in panel.marks:
                    for label, colour in _legend(mark):
                        found.setdefault(label, colour)
        return tuple(found.items())


def on_paper(colour: str) -> str:
    """The colour of a translucent ribbon on white."""
    parts = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
    return "#" + "".join(f"{round(255 - TRANSLUCENT * (255 - part)):02x}" for part in parts)


def _legend(mark: Mark) -> Sequence[tuple[str, str]]:
    if isinstance(mark, Ribbon):
        return [(mark.label, on_paper(COLOURS[mark.role]))]
    if isinstance(mark, (Line, Dots)):
        return [(mark.label, COLOURS[mark.role])] if mark.label else []
    if isinstance(mark, (Band, Spans)):
        return [(mark.label, NOISE_SHADE if isinstance(mark, Band) else SHADE)]
    return []
