"""A designed test as a table, a JSON document, a figure, and a parameters file for the reference node."""

from __future__ import annotations

import json
from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from eha_core.detectability import DesignedTest
from eha_core.diagnosis.experiment.limits import REACHED
from eha_core.diagnosis.result import Detectable, Noticeable
from eha_core.errors import EhaError
from eha_core.quantities import quantity, scale_for
from eha_core.report.detectability import detectable_row, noticeable_row
from eha_core.report.experiment_file import reference_file
from eha_core.report.study_files import write_study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "eha.design/1"
FILE = "test.yaml"
UNITS = {"position": "m", "speed": "m/s", "pressure": "Pa", "energy": "J", "voltage": "V"}
"""Units of the limits; the approach to a vacuum is only given as a share."""

_WIDTH = 100
_NAME, _CELL = 34, 34


def as_json(designed: DesignedTest) -> str:
    """The design as text, ending with a newline; SI throughout."""
    margins = designed.margins
    limits = {name: getattr(margins.limits, name) for name in REACHED}
    made = {
        "schema": SCHEMA,
        "for": list(designed.names),
        "reference": designed.signal.reference(),
        "duration": designed.test.duration,
        "channels": list(designed.test.channels),
        "found": {name: [_row(row) for row in rows] for name, rows in designed.found.items()},
        "usual": {name: [_row(row) for row in rows] for name, rows in designed.usual.items()},
        "limits": {name: value if isfinite(value) else None for name, value in limits.items()},
        "reached": {"as_modelled": margins.shares[0], "most": margins.most,
                    "most_of_usual": dict(designed.usual_most)},
        "tried": [{"kind": one.kind, "signal": one.signal.signal, "parameters": dict(one.signal.parameters),
                   "ratio": one.ratio if isfinite(one.ratio) else None} for one in designed.tried],
    }  # fmt: skip
    return json.dumps(made, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _row(row: Detectable | Noticeable) -> dict[str, Any]:
    return detectable_row(row) if isinstance(row, Detectable) else noticeable_row(row)


def account(designed: DesignedTest) -> str:
    """The design as text for the terminal."""
    lines = [*wrap(_statement(designed), _WIDTH), ""]
    head = ("smallest size found, 95 %", "designed test", "given command")
    lines.append(f"{head[0]:{_NAME + 4}}{head[1]:{_CELL}}{head[2]}")
    lines += [f"  {title:{_NAME + 2}}{new:{_CELL}}{old}".rstrip() for title, new, old in _sizes(designed)]
    of_rigs = f"most of {_rigs(designed)}"
    lines += ["", f"{'share of each limit that is used':{_NAME + 4}}{of_rigs:{_CELL}}{of_rigs}"]
    lines += [f"  {title:{_NAME + 2}}{most:{_CELL}}{usual}" for title, most, usual in _shares(designed)]
    return "\n".join(lines)


def _rigs(designed: DesignedTest) -> str:
    return f"{len(designed.margins.rigs)} rigs"


def _statement(designed: DesignedTest) -> str:
    return (
        f"{designed.kind}: a {designed.signal.signal} of voltage ({designed.signal.settings()}) for"
        f" {designed.test.duration:g} s shows most of {', '.join(designed.names)}, among {len(designed.tried)} signals"
        " that stay within the limits"
    )


def _sizes(designed: DesignedTest) -> Iterator[tuple[str, str, str]]:
    for name in designed.names:
        for new, old in zip(designed.found[name], designed.usual[name], strict=True):
            title = f"{name}, {new.parameter}" if isinstance(new, Detectable) else name
            yield title, _size(new), _size(old)


def _size(row: Detectable | Noticeable) -> str:
    size = row.size if isinstance(row, Detectable) else row.change
    if size is None:
        return "not found"
    flow = f" ({quantity(row.flow, 'm^3/s')})" if row.flow else ""
    return f"{quantity(size, row.unit)}{flow}"


def _shares(designed: DesignedTest) -> Iterator[tuple[str, str, str]]:
    """Each finite limit in words, and the shares of it that the two tests use."""
    margins = designed.margins
    for name, share in margins.shares[0].items():
        limit = getattr(margins.limits, name, None)
        if limit is not None and not isfinite(limit):
            continue
        title = "vacuum in a chamber" if limit is None else f"{name}, {quantity(limit, UNITS[name])}"
        modelled = f"{100.0 * margins.most[name]:.0f} % (as modelled {100.0 * share:.0f} %)"
        yield title, modelled, f"{100.0 * designed.usual_most[name]:.0f} %"


def parameters_file(designed: DesignedTest) -> str:
    """The test as a parameters file of the reference node."""
    test = designed.test
    heading = [
        _statement(designed),
        f"Record voltage_command, {', '.join(test.channels)} at {test.rate:g} Hz.",
        f"ros2 run eha_sim_node reference --ros-args --params-file {FILE}",
    ]
    parameters = {**designed.signal.reference(), "rate": float(test.rate), "duration": float(test.duration)}
    return reference_file(heading, parameters)


def write_design(designed: DesignedTest, folder: Path) -> tuple[Path, ...]:
    """Write design.json, design.png and test.yaml into a folder, made when missing; return their paths.

    Raises EhaError where the folder cannot be written to.
    """
    written = write_study(folder, "design", as_json(designed), picture(designed))
    path = folder / FILE
    try:
        path.write_text(parameters_file(designed), encoding="utf-8")
    except OSError as error:
        raise EhaError(f"{path}: cannot be written ({error.strerror}); choose another --out") from error
    return (*written, path)


def picture(designed: DesignedTest) -> Figure:
    """Figure of voltage, position, speed and pressures with their limits: as modelled, and over the sampled rigs."""
    from matplotlib.figure import Figure  # plotting loads slowly, and a table needs none

    from eha_core.report.picture import COLOURS

    margins, test = designed.margins, designed.test
    assert margins.bands is not None and margins.time is not None, "the test was simulated"
    figure = Figure(figsize=(10.0, 8.0), layout="constrained")
    axes = figure.subplots(4, 1, sharex=True)
    axes[0].step(test.times, test.voltages, where="post", color=COLOURS["measured"], linewidth=1.0)
    axes[0].set_ylabel("voltage [V]")
    drawn = (("position", "position", ("position",)), ("velocity", "speed", ("velocity",)),
             ("pressure", "pressure", ("pressure_a", "pressure_b")))  # fmt: skip
    for place, (title, limit, names) in zip(axes[1:], drawn, strict=True):
        highest = getattr(margins.limits, limit)
        scale = scale_for(UNITS[limit], float(np.max(np.abs(margins.bands[names[0]]))))
        for name, role in zip(names, ("after", "calibrated"), strict=False):
            low, middle, high = margins.bands[name] / scale.factor
            label = name.replace("_", " ")
            place.fill_between(margins.time, low, high, color=COLOURS[role], alpha=0.25, linewidth=0.0)
            place.plot(margins.time, middle, color=COLOURS[role], linewidth=1.0, label=label)
        if isfinite(highest):
            ends = (highest,) if limit == "pressure" else (highest, -highest)
            for end in ends:
                place.axhline(end / scale.factor, color=COLOURS["before"], linewidth=1.0, linestyle="--")
        place.set_ylabel(f"{title} [{scale.unit}]")
        if len(names) > 1:
            place.legend(frameon=False, fontsize=8, ncols=2, loc="upper right")
    for each in axes:
        each.grid(True, linewidth=0.3)
    axes[-1].set_xlabel("time [s]")
    figure.suptitle(f"Line: as modelled; area: {_rigs(designed)} within their priors; dashed: limits", fontsize=9)
    return figure
