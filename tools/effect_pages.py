"""A page of the documentation for an effect: its docstring, equation, parameters, and what it looks like in data."""

from __future__ import annotations

from importlib import import_module
from inspect import getdoc
from io import BytesIO

import numpy as np

from eha_core.effects import SITES, Effect, effect_title, effects
from eha_core.identification.numbers import Array
from eha_core.plant import Plant, Trajectory
from eha_core.report.figures import drawn
from eha_core.report.picture import Dots, Group, Line, Panel, Picture
from eha_core.report.wording import capital
from eha_core.signals import make_signal

SECONDS, STEP, EVERY = 4.0, 1e-4, 20
TEST = {"amplitude": 0.12, "lowest": 0.3, "highest": 8.0, "count": 16, "period": 20.0, "seed": 5}
"""The voltage that the pictures are made with: the identification experiment's."""

LATER = {"leakage_onset.time": 2.0, "thermal_drift.time_constant": 2.0}
"""What has to happen within the picture's time [s]."""


def named_effects() -> list[Effect]:
    """The effects that a diagnosis can name, by site."""
    return [effect for effect in effects() if effect.named]


def table_of_all() -> str:
    """The catalogue's first page."""
    lines = [
        "# Catalogue of effects",
        "",
        "Each effect is one file of `eha_core/effects/`; this page and the others are made from their docstrings.",
    ]
    for site in SITES:
        here = [effect for effect in named_effects() if effect.site == site]
        lines += ["", f"## {capital(SITES[site].words)}", "", "| effect | what it is |", "|---|---|"]
        lines += [f"| [{effect_title(one.id)}]({one.id}.md) | {_summary(one)} |" for one in here]
    return "\n".join(lines) + "\n"


def page_of(effect: Effect) -> str:
    """One effect's page."""
    summary, _, rest = _docstring(effect).partition("\n\n")
    parts = [f"# {capital(effect_title(effect.id))}", "", " ".join(summary.split()), ""]
    parts += [f"It acts {SITES[effect.site].words}.", "", "```text", effect.equation, "```", ""]
    parts += [f"![{effect_title(effect.id)}: what it changes]({effect.id}.png)", ""]
    for name, text in _paragraphs(rest):
        parts += [f"**{name}.** {text}", ""] if name else [text, ""]
    parts += [
        "## Parameters",
        "",
        "| parameter | unit | off at | range | meaning | source |",
        "|---|---|---|---|---|---|",
    ]
    for name, row in zip(effect.parameter_names(), effect.parameters, strict=True):
        bounds = f"{row.lower:g} to {row.upper:g}"
        parts.append(f"| `{name}` | {row.unit} | {row.nominal:g} | {bounds} | {row.meaning} | {row.source} |")
    settings = " ".join(f"--set {name}={value:g}" for name, value in typical(effect).items())
    signal = ",".join(f"{name}={value:g}" for name, value in TEST.items())
    parts += ["", "## Try it", "", "```sh", f"eha simulate --command multisine:{signal} --duration {SECONDS:g} \\"]
    parts += [f"    {settings} --out {effect.id}.mcap", "```", ""]
    return "\n".join(parts)


def picture_of(effect: Effect) -> bytes:
    """What the effect does to a recording, as PNG: its phase portrait and how far each signal moves."""
    time = np.arange(round(SECONDS / STEP / EVERY)) * STEP * EVERY
    voltage = np.repeat(np.asarray(make_signal("multisine", TEST).value(time)), EVERY)
    without, having = (Plant(values, STEP).run(voltage, EVERY) for values in ({}, typical(effect)))
    picture = Picture(
        effect.id,
        (
            Group((_portrait(without, having),)),
            Group(
                (
                    _moved("Position", "µm", 1e6, having.time, having.measured_position - without.measured_position),
                    _moved(
                        "Pressure A", "kPa", 1e-3, having.time, having.measured_pressure_a - without.measured_pressure_a
                    ),
                )
            ),
        ),
        (2, 3),
    )
    stream = BytesIO()
    drawn(picture).savefig(stream, dpi=75, format="png")
    return stream.getvalue()


def _portrait(without: Trajectory, having: Trajectory) -> Panel:
    marks = tuple(
        Dots(1e3 * run.measured_velocity, 1e-3 * (run.measured_pressure_a - run.measured_pressure_b), role, label)
        for run, role, label in ((without, "before", "nominal model"), (having, "after", "with the effect"))
    )
    return Panel(marks, "velocity [mm/s]", "pressure difference [kPa]", "Pressure difference over velocity", 330)


def _moved(name: str, unit: str, scale: float, time: Array, difference: Array) -> Panel:
    return Panel((Line(time, scale * difference, "after"),), "time [s]", unit, f"{name}: what the effect changes", 130)


def typical(effect: Effect) -> dict[str, float]:
    """The effect at a size that matters."""
    names = zip(effect.parameter_names(), effect.parameters, strict=True)
    return {name: LATER.get(name, row.typical if row.typical or row.switches else row.nominal) for name, row in names}


def _docstring(effect: Effect) -> str:
    return getdoc(import_module(f"eha_core.effects.{effect.id}")) or ""


def _summary(effect: Effect) -> str:
    return " ".join(_docstring(effect).partition("\n\n")[0].split())


def _paragraphs(text: str) -> list[tuple[str, str]]:
    """The docstring's named paragraphs: (Signature, ...), (Equation, ...)."""
    found: list[tuple[str, str]] = []
    for line in text.splitlines():
        name, colon, rest = line.partition(": ")
        if colon and name in ("Signature", "Equation", "Sign", "Validity", "Source"):
            found.append((name, rest))
        elif found and line.strip():
            found[-1] = (found[-1][0], f"{found[-1][1]} {line.strip()}")
        elif line.strip():
            found.append(("", line.strip()))
    return found
