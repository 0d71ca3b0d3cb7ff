"""Draws pictures for the page as Plotly's JSON: traces, axes and shapes as plain data.

Plotly's Python classes are not used: they check every field of every drawing, which takes longer than all the rest of a
page.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from typing import Any

import numpy as np

from eha_core.identification.numbers import Array
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
    Ribbon,
    Spans,
    Upright,
)

FONT = "Inter, system-ui, -apple-system, 'Segoe UI', Roboto, Helvetica, Arial, sans-serif"
INK, QUIET, GRID, AXIS = "#22303c", "#5c6b78", "#edf0f2", "#c9d1d7"
TITLE_HEIGHT, FOOT = 30, 46
"""Pixels above a panel for its title, and below the last for its axis."""

Drawing = dict[str, Any]


def figure(group: Group) -> Drawing:
    """A group as Plotly's `data` and `layout`; its height is in the layout."""
    heights = [panel.height for panel in group.panels]
    inner = sum(heights) + TITLE_HEIGHT * (len(heights) - 1)
    top = TITLE_HEIGHT if group.panels[0].title else 8
    layout: Drawing = {
        "height": inner + top + FOOT,
        "font": {"family": FONT, "size": 12, "color": QUIET},
        "margin": {"l": 58, "r": 14, "t": top, "b": FOOT},
        "showlegend": False,
        "hovermode": "closest",
        "hoverlabel": {"font": {"family": FONT, "size": 12}, "bgcolor": "#ffffff", "bordercolor": "#cfd6db"},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "bargap": 0.42,
        "annotations": [],
        "shapes": [],
    }
    data: list[Drawing] = []
    ceiling = float(inner)
    for row, panel in enumerate(group.panels):
        suffix = str(row + 1) if row else ""
        domain = (max(0.0, (ceiling - panel.height) / inner), ceiling / inner)
        ceiling -= panel.height + TITLE_HEIGHT
        layout[f"xaxis{suffix}"] = _across(panel, suffix, row == len(heights) - 1)
        layout[f"yaxis{suffix}"] = _up(panel, suffix, domain)
        layout["annotations"].append(_title(panel.title, domain[1]))
        for mark in panel.marks:
            axes = {"xaxis": f"x{suffix}", "yaxis": f"y{suffix}"}
            data += [{**trace, **axes} for trace in _traces(mark, panel.y_label)]
            layout["shapes"] += _shapes(mark, suffix)
    return {"data": data, "layout": layout}


def _axis(text: str, standoff: int) -> Drawing:
    return {
        "gridcolor": GRID,
        "zerolinecolor": AXIS,
        "linecolor": AXIS,
        "showline": True,
        "ticks": "",
        "title": {"text": text, "standoff": standoff},
    }


def _across(panel: Panel, suffix: str, last: bool) -> Drawing:
    axis = {**_axis(panel.x_label if last else "", 8), "anchor": f"y{suffix}", "showticklabels": last}
    if suffix:
        axis["matches"] = "x"
    if panel.x_range:
        axis["range"] = panel.x_range
    if any(isinstance(mark, Cells) for mark in panel.marks):
        places = list(range(len(panel.names)))
        numbers = [str(place + 1) for place in places]
        axis |= {"tickvals": places, "ticktext": numbers, "tickangle": 0, "showgrid": False}
    if panel.x_ticks:
        axis |= {
            "tickvals": [place for place, _ in panel.x_ticks],
            "ticktext": [text for _, text in panel.x_ticks],
            "zeroline": False,
        }
    return axis


def _up(panel: Panel, suffix: str, domain: tuple[float, float]) -> Drawing:
    axis = {**_axis(panel.y_label, 6), "anchor": f"x{suffix}", "domain": domain, "automargin": True}
    if panel.y_range:
        axis["range"] = panel.y_range
    if panel.names:
        axis |= {
            "tickvals": list(range(len(panel.names))),
            "ticktext": ["<br>".join(lines) for lines in panel.row_labels],
            "range": (len(panel.names) - 0.4, -0.6),
            "showgrid": False,
            "zeroline": False,
        }
    return axis


def _title(text: str, place: float) -> Drawing:
    return {
        "text": text,
        "font": {"size": 13, "color": INK, "weight": 600},
        "x": 0.0,
        "xref": "paper",
        "xanchor": "left",
        "y": place,
        "yref": "paper",
        "yanchor": "bottom",
        "yshift": 4,
        "showarrow": False,
    }


def _packed(values: Array) -> Drawing:
    """Single precision in base64: half the bytes, and seven digits are more than a screen shows."""
    return {"dtype": "f4", "bdata": b64encode(np.asarray(values, dtype="<f4").tobytes()).decode()}


def _traces(mark: Mark, unit: str) -> Iterator[Drawing]:
    if isinstance(mark, (Line, Dots)):
        yield {
            "type": "scatter",
            "x": _packed(mark.x),
            "y": _packed(mark.y),
            "name": mark.label,
            "hovertemplate": f"%{{y:.5g}} {unit}<br>at %{{x:.4g}}<extra>{mark.label}</extra>",
            **_style(mark),
        }
    elif isinstance(mark, Ribbon):
        yield {
            "type": "scatter",
            "x": _packed(np.concatenate([mark.x, mark.x[::-1]])),
            "y": _packed(np.concatenate([mark.high, mark.low[::-1]])),
            "name": mark.label,
            "fill": "toself",
            "fillcolor": _translucent(COLOURS[mark.role]),
            "line": {"width": 0},
            "mode": "lines",
            "hoverinfo": "skip",
        }
    elif isinstance(mark, Intervals):
        for row, (name, text, role) in enumerate(zip(mark.names, mark.texts, mark.roles, strict=True)):
            reach = {"type": "data", "array": [float(mark.reach[row])], "thickness": 2, "width": 4}
            yield {
                "type": "scatter",
                "x": [float(mark.x[row])],
                "y": [row],
                "mode": "markers",
                "marker": {"color": COLOURS[role], "size": 9},
                "error_x": {**reach, "color": COLOURS[role]},
                "hovertemplate": f"{name}<br>{text}<extra></extra>",
            }
    elif isinstance(mark, Bars):
        yield {
            "type": "bar",
            "orientation": "h",
            "x": [float(value) for value in mark.x],
            "y": list(range(len(mark.x))),
            "text": mark.texts,
            "textposition": "outside",
            "cliponaxis": False,
            "marker": {"color": [COLOURS[role] for role in mark.roles]},
            "hovertemplate": "%{text}<extra></extra>",
        }
    elif isinstance(mark, Cells):
        yield {
            "type": "heatmap",
            "z": [[round(float(value), 3) for value in row] for row in mark.values],
            "zmin": mark.low,
            "zmax": mark.high,
            "colorscale": [[0.0, COLOURS["before"]], [0.5, "#ffffff"], [1.0, COLOURS["after"]]],
            "xgap": 1,
            "ygap": 1,
            "colorbar": {"thickness": 10, "outlinewidth": 0, "len": 0.6},
            "text": [[f"{name}<br>{other}" for other in mark.names] for name in mark.names],
            "hovertemplate": "%{text}<br>%{z:.2f}<extra></extra>",
        }


def _style(mark: Line | Dots) -> Drawing:
    if isinstance(mark, Line):
        line = {"color": COLOURS[mark.role], "width": mark.width, "dash": "dash" if mark.dashed else "solid"}
        return {"mode": "lines", "line": line}
    return {"mode": "markers", "marker": {"color": COLOURS[mark.role], "size": mark.size, "opacity": 0.45}}


def _translucent(colour: str) -> str:
    red, green, blue = (int(colour[place : place + 2], 16) for place in (1, 3, 5))
    return f"rgba({red},{green},{blue},{TRANSLUCENT})"


def _shapes(mark: Mark, suffix: str) -> Iterator[Drawing]:
    common = {"type": "rect", "layer": "below", "line": {"width": 0}}
    if isinstance(mark, Band):
        place = {"xref": f"x{suffix} domain", "yref": f"y{suffix}", "x0": 0, "x1": 1, "y0": mark.low, "y1": mark.high}
        yield {**common, **place, "fillcolor": NOISE_SHADE, "name": mark.label}
    elif isinstance(mark, Upright):
        place = {"xref": f"x{suffix}", "yref": f"y{suffix} domain", "x0": mark.x, "x1": mark.x, "y0": 0, "y1": 1}
        line = {"width": 1.2, "dash": "dot", "color": INK}
        label = {"text": mark.label, "textposition": "end", "textangle": 0, "xanchor": "left", "yanchor": "top"}
        yield {**place, "type": "line", "line": line, "label": {**label, "font": {"size": 11, "color": QUIET}}}
    elif isinstance(mark, Spans):
        for start, end in mark.spans:
            place = {"xref": f"x{suffix}", "yref": f"y{suffix} domain", "x0": start, "x1": end, "y0": 0, "y1": 1}
            yield {**common, **place, "fillcolor": SHADE, "opacity": 0.75, "name": mark.label}
