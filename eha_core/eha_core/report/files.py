"""Writes everything that `eha diagnose` leaves in its folder."""

from __future__ import annotations

from pathlib import Path

from eha_core.diagnosis.document import as_json
from eha_core.diagnosis.result import Diagnosis
from eha_core.errors import EhaError
from eha_core.parameters import dump_parameters
from eha_core.report.comparison import write_comparison
from eha_core.report.figures import write_figures
from eha_core.report.html import write_page
from eha_core.report.stages import story


def write_report(diagnosis: Diagnosis, folder: Path) -> tuple[Path, ...]:
    """Write report.html, figures/, diagnosis.json, fitted.yaml and comparison.mcap; files of an earlier run go.

    Returns what was written, most readable first. Raises EhaError where the folder cannot be written to.
    """
    page, document, fitted = folder / "report.html", folder / "diagnosis.json", folder / "fitted.yaml"
    comparison = folder / "comparison.mcap"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for old in (folder / "figures").glob("[1-7]-*.png"):
            old.unlink()
        comparison.unlink(missing_ok=True)
        document.write_text(as_json(diagnosis), encoding="utf-8")
        fitted.write_text(dump_parameters(diagnosis.fitted_values, _heading(diagnosis)), encoding="utf-8")
        write_comparison(diagnosis, comparison)
        write_figures([picture for stage in story(diagnosis) for picture in stage.pictures], folder / "figures")
        write_page(diagnosis, page)
    except OSError as error:
        raise EhaError(
            f"{error.filename or folder}: cannot be written ({error.strerror}); choose another --out"
        ) from error
    return (page, folder / "figures", document, fitted, comparison)


def _heading(diagnosis: Diagnosis) -> str:
    return f"Fitted to {Path(diagnosis.path).name}\n{' '.join(diagnosis.summary.split())}"
