"""Step tests of a valve as an account for people, as a document for programs, and as a picture."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from eha_core.quantities import quantity, with_deviation
from eha_core.report.study_files import write_study
from eha_core.report.wording import listed
from eha_core.step_tests import Direction, Estimate, Step, StepTests

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "eha.steps/1"
"""The schema of steps.json."""

_WIDTH = 100
_LABELS = {
    "dead_zone": "dead zone", "gain": "gain", "delay": "delay", "end_stop": "end stop", "speed": "speed",
    "rise": "time constant", "stopping": "delay of stopping", "level": "motion or none",
}  # fmt: skip
_SIDES = {1: "positive commands", -1: "negative commands"}


def document(tests: StepTests) -> dict[str, Any]:
    """The steps as plain JSON types, in the units that it names; `reach` is half of a 95 % interval, times in s."""
    steps = [{key: value for key, value in asdict(step).items() if key != "drawn"} for step in tests.steps]
    return {
        "schema": SCHEMA,
        "units": {"command": tests.command_unit, "motion": tests.motion_unit, "speed": tests.speed_unit, "time": "s"},
        "directions": [asdict(direction) for direction in tests.directions],
        "steps": steps,
        "remarks": list(tests.remarks),
    }


def as_json(tests: StepTests) -> str:
    """The document as text, ending with a newline."""
    return json.dumps(document(tests), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_steps(tests: StepTests, folder: Path) -> tuple[Path, ...]:
    """Write steps.json and steps.png into a folder, made when missing; return their paths.

    Raises EhaError where the folder cannot be written to.
    """
    return write_study(folder, "steps", as_json(tests), picture(tests))


def account(tests: StepTests) -> str:
    """The steps as text for the terminal; intervals of 95 %."""
    lines = [*_table(tests), ""]
    lines += [line for text in _reasons(tests.steps) for line in _note(text)]
    for direction in tests.directions:
        lines += ["" if lines[-1] else None, *_together(tests, direction)]  # type: ignore[list-item]
    lines += [line for remark in tests.remarks for line in _note(f"Note: {remark}")]
    return "\n".join(line for line in lines if line is not None)


def _note(text: str) -> list[str]:
    return wrap(f"  {text}", _WIDTH, subsequent_indent="    ")


def _table(tests: StepTests) -> list[str]:
    heading = ["step", "file", "level", "delay", "time constant", "speed", "stopping", "stopped at"]
    rows = [heading, *(_cells(tests, number, step) for number, step in enumerate(tests.steps, start=1))]
    widths = [max(len(row[place]) for row in rows) for place in range(len(heading))]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]


def _cells(tests: StepTests, number: int, step: Step) -> list[str]:
    level = quantity(step.level, tests.command_unit)
    if not step.moved:
        return [str(number), step.source, level, "open" if "level" in step.open else "no motion", "", "", "", ""]
    stopped = "" if step.stopped_after is None else f"after {quantity(step.stopped_after, 's')}"
    if step.stopped_at is not None:
        stopped = with_deviation(step.stopped_at.value, step.stopped_at.reach, tests.motion_unit)
    return [
        str(number), step.source, level, _shown(step.delay, "s"), _at_most(step.rise),
        _shown(step.speed, tests.speed_unit), _shown(step.stopping, "s"), stopped,
    ]  # fmt: skip


def _shown(estimate: Estimate | None, unit: str) -> str:
    return "open" if estimate is None else with_deviation(estimate.value, estimate.reach, unit)


def _at_most(estimate: Estimate | None) -> str:
    """A time constant; its upper end where zero is not excluded."""
    if estimate is None or estimate.is_sure:
        return _shown(estimate, "s")
    return f"at most {quantity(estimate.value + estimate.reach, 's', 2)}"


def _reasons(steps: Sequence[Step]) -> Iterable[str]:
    """Why figures of steps are open, steps with the same reason together; a step without motion says it itself."""
    found: dict[tuple[str, tuple[str, ...]], list[str]] = {}
    for number, step in enumerate(steps, start=1):
        if not step.moved and "level" not in step.open:
            continue
        figures: dict[str, list[str]] = {}
        for figure, reason in step.open.items():
            figures.setdefault(reason, []).append(figure)
        for reason, names in figures.items():
            shown = tuple(_LABELS[name] for name in names if name in _LABELS)
            found.setdefault((reason, shown), []).append(str(number))
    for (reason, shown), numbers in found.items():
        yield f"{'steps' if len(numbers) > 1 else 'step'} {listed(numbers)}, {listed(shown)} open: {reason}"


def _together(tests: StepTests, direction: Direction) -> list[str]:
    command, speed = tests.command_unit, tests.speed_unit
    counted = f"{direction.steps} {'steps' if direction.steps > 1 else 'step'}"
    lines = [
        f"{_SIDES[direction.sign]}: {counted} of {direction.levels} {'levels' if direction.levels > 1 else 'level'}"
    ]
    lines.append(_row("motion begins", _bracket(tests, direction)))
    for name, estimate, unit in (
        ("dead_zone", direction.dead_zone, command), ("gain", direction.gain, f"{speed} per {command}"),
        ("delay", direction.delay, "s"), ("end_stop", direction.end_stop, tests.motion_unit),
    ):  # fmt: skip
        if estimate is not None:
            doubt = "" if estimate.is_sure or name != "dead_zone" else "  (none found: the interval includes zero)"
            lines.append(_row(_LABELS[name], _shown(estimate, unit) + doubt))
    if direction.saturation is not None:
        lines.append(
            _row("saturation", f"{_shown(direction.saturation, speed)} from {_shown(direction.knee, command)} on")
        )
    if direction.delay_slope is not None:
        lines.append(_row("delay over the level", f"{_shown(direction.delay_slope, 's')} per {command}"))
    lines += [line for text in _openings(direction) for line in _note(text)]
    return lines + [line for remark in direction.remarks for line in _note(f"Note: {remark}")]


def _openings(direction: Direction) -> Iterable[str]:
    """What is open of a direction, figures with the same reason together."""
    found: dict[str, list[str]] = {}
    for figure, reason in direction.open.items():
        found.setdefault(reason, []).append(_LABELS[figure])
    return (f"open: {listed(names)}: {reason}" for reason, names in found.items())


def _bracket(tests: StepTests, direction: Direction) -> str:
    still, moving = (
        None if level is None else quantity(level, tests.command_unit) for level in (direction.still, direction.moving)
    )
    # three digits of a limit would say too much
    unseen = "" if direction.unseen is None else f", or below {quantity(direction.unseen, tests.speed_unit, 1)}"
    if still is None and moving is None:
        return "open"
    if still is None:
        return f"at {moving} or below"
    if moving is None:
        return f"not up to {still} (no motion{unseen})"
    if (direction.still or 0.0) > (direction.moving or 0.0):
        return f"not clear: {moving} moved, {still} did not"
    return f"between {still} (no motion{unseen}) and {moving} (motion)"


def _row(label: str, text: str) -> str:
    return f"  {label:24}{text}"


def picture(tests: StepTests) -> Figure:
    """Figure of all motions since the command's change, with the fitted laws, and of the speeds over the level."""
    from matplotlib.figure import Figure  # plotting loads slowly, and an account needs none

    figure = Figure(figsize=(11.0, 4.4), layout="constrained")
    motions, speeds = figure.subplots(1, 2)
    _draw_motions(motions, tests)
    _draw_speeds(speeds, tests)
    for axes in (motions, speeds):
        axes.grid(True, linewidth=0.3)
        axes.spines[["top", "right"]].set_visible(False)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False, fontsize=9)
    return figure


def _draw_motions(axes: Any, tests: StepTests) -> None:
    from eha_core.report.picture import COLOURS

    labels = ("measured", "fitted")
    for step in tests.steps:
        if step.drawn is None:
            continue
        time, motion, law = step.drawn
        axes.plot(time, motion - step.places[0], ".", color=COLOURS["other"], markersize=2, label=labels[0])
        axes.plot(time, law - step.places[0], color=COLOURS["after"], linewidth=1.0, label=labels[1])
        labels = ("", "")
    what = "velocity" if tests.is_velocity else "motion from rest"
    axes.set_xlabel("time since the command's change [s]")
    axes.set_ylabel(f"{what} [{tests.motion_unit}]")
    axes.set_title("useful part of each step", loc="left", fontsize=11)


def _draw_speeds(axes: Any, tests: StepTests) -> None:
    from eha_core.report.picture import COLOURS

    for step in tests.steps:
        if step.speed is not None:
            axes.errorbar(
                step.level, step.speed.value, step.speed.reach, fmt="o", color=COLOURS["measured"], markersize=3
            )
        elif not step.moved and "level" not in step.open:
            axes.plot(step.level, 0.0, "o", color=COLOURS["measured"], markersize=4, markerfacecolor="none")
    for direction in tests.directions:
        if direction.gain is not None and direction.dead_zone is not None:
            largest = max(abs(step.level) for step in tests.steps if step.sign == direction.sign)
            end = direction.knee.value if direction.knee is not None else largest
            levels = np.array([direction.dead_zone.value, end, max(end, largest)])
            speeds = direction.gain.value * (np.minimum(levels, end) - direction.dead_zone.value)
            axes.plot(direction.sign * levels, speeds, color=COLOURS["after"], linewidth=1.1)
    axes.axhline(0.0, color=COLOURS["other"], linewidth=0.6)
    axes.set_xlabel(f"level [{tests.command_unit}]")
    axes.set_ylabel(f"steady speed [{tests.speed_unit}]")
    axes.set_title("speed over level; open circles: no motion", loc="left", fontsize=11)
