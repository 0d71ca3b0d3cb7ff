"""Seals of a pneumatic cylinder at four pressures: only the pressure was changed, so one law has to hold at all."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np

from eha_core.known_answers.real.originals import original
from eha_core.known_answers.real.question import Question
from eha_core.known_answers.real.sealing import Array, seal, write_csv
from eha_core.motion_given import Motion, find_law, fit_law, motion_of, predict
from eha_core.recording import Recording

RIG = "pneumatic seal"
SEALS = {"O-ring": "NAPN", "NAPN": "O-ring"}
"""Each seal, and the other one, on whose recordings the form of its law is found."""

PRESSURES = (1, 3, 5, 7)
AREA = pi * 0.0125**2
"""m^2 of the 25 mm cylinder."""

ATMOSPHERE = 101325.0
"""Pa that a gauge pressure is short of an absolute one."""

DROPPED = 15
"""Samples at the start that its authors drop."""

LARGEST_ERROR = 0.25
"""RMS error over the RMS of the friction at a pressure that was not fitted."""

PRESSED = ("load_friction", "contact_friction")


def ask(data: Path, out: Path) -> list[Question]:
    """The seals' questions; `out` takes the sealed predictions."""
    for name in SEALS:
        for pressure in PRESSURES:
            time, displacement, bar = read(data, name, pressure, (0, 4, 5))
            columns = {"time": 1e-3 * time, "position": -1e-3 * displacement, "pressure_a": 1e5 * bar + ATMOSPHERE}
            write_csv(out / f"{name}_{pressure}bar.csv", {**columns, "force": friction(data, name, pressure)})
    forms = {}
    questions = []
    for name in SEALS:
        law = find_law([_motion(data, name, pressure) for pressure in PRESSURES])
        forms[name] = law.ids
        values = (f"{part} {law.values[part][next(iter(law.values[part]))].value:.3g}" for part in law.ids)
        questions.append(
            Question(
                RIG,
                f"{name}: one law for 1, 3, 5 and 7 bar",
                "friction grows with pressure",
                f"{', '.join(values)} [SI]; {100 * law.share_left:.0f} % left on held-out blocks",
                any(part in law.ids for part in PRESSED),
            )
        )
    for name, other in SEALS.items():
        questions += [_left_out(data, out, name, pressure, forms[other]) for pressure in PRESSURES]
    return questions


def read(data: Path, name: str, pressure: int, columns: tuple[int, ...]) -> Array:
    """Columns of one file: time [ms], 1 to 3 in V, displacement [mm], pressure [bar gauge], force [N].

    Raises:
        EhaError: the file is not there.
    """
    return np.asarray(np.loadtxt(original(data, f"{name}_{pressure}bar.csv"), usecols=columns)[DROPPED:].T)


def friction(data: Path, name: str, pressure: int) -> Array:
    """The pressure's force less the measured one [N], as the data's README defines it."""
    bar, force = read(data, name, pressure, (5, 6))
    return np.asarray(1e5 * bar * AREA - force)


def _motion(data: Path, name: str, pressure: int, with_force: bool = True) -> Motion:
    """The displacement counts against the pressure's force: its sign is turned."""
    time, displacement, bar = read(data, name, pressure, (0, 4, 5))
    force = friction(data, name, pressure) if with_force else np.zeros_like(time)
    return motion_of(
        Recording.from_arrays(
            time=1e-3 * time, position=-1e-3 * displacement, pressure_a=1e5 * bar, force=force, pressures="gauge",
            name=f"{name} at {pressure} bar",
        )
    )  # fmt: skip


def _left_out(data: Path, out: Path, name: str, pressure: int, form: tuple[str, ...]) -> Question:
    law = fit_law([_motion(data, name, other) for other in PRESSURES if other != pressure], form)
    motion = _motion(data, name, pressure, with_force=False)
    time = 1e-3 * read(data, name, pressure, (0,))
    sealed = seal(out, f"{name}_{pressure}bar", np.interp(time - time[0], motion.time, predict(law, motion)))
    measured = friction(data, name, pressure)
    error = float(np.sqrt(np.mean((sealed.open() - measured) ** 2) / np.mean(measured**2)))
    return Question(
        RIG,
        f"{name}: friction at {pressure} bar from the other pressures, its form from {SEALS[name]}",
        f"measured; within {100 * LARGEST_ERROR:.0f} %",
        f"{100 * error:.1f} %",
        error <= LARGEST_ERROR,
        sealed.short,
    )
