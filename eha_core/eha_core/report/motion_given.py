"""The output files of `eha diagnose` for a recording whose motion is given: page, document and a figure of the law."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from eha_core.errors import EhaError
from eha_core.motion_given import Found, Motion
from eha_core.motion_given.diagnose import curve
from eha_core.report.document import as_json
from eha_core.report.figures import write_figures
from eha_core.report.picture import Dots, Group, Line, Panel, Picture

DRAWN = 4000
"""Samples of a recording that are drawn."""

NAME = "law"
"""The figure's file, without its ending."""


def write_motion_given(found: Found, folder: Path) -> tuple[Path, ...]:
    """Write report.html, diagnosis.json and figures/law.png; returns what was written.

    Raises:
        EhaError: the folder cannot be written to.
    """
    # the page draws with this module's picture, and loads slowly
    from eha_core.report.motion_page import motion_page

    page, document = folder / "report.html", folder / "diagnosis.json"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        document.write_text(as_json(found.diagnosis), encoding="utf-8")
        write_figures([law_picture(found)], folder / "figures")
        page.write_text(motion_page(found), encoding="utf-8")
    except OSError as error:
        raise EhaError(
            f"{error.filename or folder}: cannot be written ({error.strerror}); choose another --out"
        ) from error
    return (page, folder / "figures", document)


def law_picture(found: Found) -> Picture:
    """The force and the law's residual over speed and over position, of the recording with the largest force."""
    motion = max(found.motions, key=lambda motion: float(np.std(motion.force)))
    force, left = curve(found.law, motion)
    rows = np.flatnonzero(motion.used)[:: max(1, len(motion.time) // DRAWN)]
    groups = [
        Group(_panels(motion, rows, x[rows], label, force, left))
        for x, label in ((1e3 * motion.velocity, "velocity [mm/s]"), (1e3 * motion.position, "position [mm]"))
    ]
    return Picture(NAME, tuple(groups), (1, 1), f"{motion.name}: the force that the motion requires")


def _panels(motion: Motion, rows, x, label: str, force, left) -> tuple[Panel, Panel]:  # type: ignore[no-untyped-def]
    return (
        Panel(
            (Dots(x, motion.force[rows], "measured", "measured"), Line(x, force[rows], "after", "law", 1.0)),
            label, "force [N]", "Measured force and the law", 320,
        ),
        Panel((Dots(x, left[rows], "other", "residual"),), label, "force [N]", "Residual of the law", 160),
    )  # fmt: skip
