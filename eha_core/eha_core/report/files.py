"""Writes the output files of `eha diagnose`."""

from __future__ import annotations

from pathlib import Path

from eha_core.diagnosis.result import Diagnosis
from eha_core.errors import EhaError
from eha_core.plant import dump_plant
from eha_core.report.document import as_json
from eha_core.report.experiment_file import FILE, experiment_file


def write_report(diagnosis: Diagnosis, folder: Path) -> tuple[Path, ...]:
    """Write report.html, figures/, diagnosis.json, fitted.yaml, comparison.mcap and, where a test is proposed,
    next_experiment.yaml; those of an earlier run are removed.

    Returns the paths, the most readable first. Raises EhaError where the folder cannot be written to.
    """
    # plotting loads slowly, and the document alone needs none
    from eha_core.report.comparison import write_comparison
    from eha_core.report.contents import contents_of
    from eha_core.report.figures import write_figures
    from eha_core.report.html import write_page

    page, document, fitted = folder / "report.html", folder / "diagnosis.json", folder / "fitted.yaml"
    comparison, experiment = folder / "comparison.mcap", folder / FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for old in (folder / "figures").glob("[0-7]-*.png"):
            old.unlink()
        comparison.unlink(missing_ok=True)
        document.write_text(as_json(diagnosis), encoding="utf-8")
        found = dump_plant(diagnosis.fitted_values, diagnosis.composition, _heading(diagnosis))
        fitted.write_text(found, encoding="utf-8")
        write_comparison(diagnosis, comparison)
        contents = contents_of(diagnosis)
        write_figures(contents.figures, folder / "figures")
        experiment.unlink(missing_ok=True)
        if diagnosis.next_experiment is not None and diagnosis.next_experiment.reference:
            experiment.write_text(experiment_file(diagnosis, diagnosis.next_experiment), encoding="utf-8")
        write_page(diagnosis, page, contents)
    except OSError as error:
        raise EhaError(
            f"{error.filename or folder}: cannot be written ({error.strerror}); choose another --out"
        ) from error
    proposed = (experiment,) if experiment.exists() else ()
    return (page, folder / "figures", document, fitted, comparison, *proposed)


def write_document(diagnosis: Diagnosis, folder: Path) -> tuple[Path, ...]:
    """Write diagnosis.json alone, and return its path. Raises EhaError where the folder cannot be written to."""
    document = folder / "diagnosis.json"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        document.write_text(as_json(diagnosis), encoding="utf-8")
    except OSError as error:
        raise EhaError(
            f"{error.filename or folder}: cannot be written ({error.strerror}); choose another --out"
        ) from error
    return (document,)


def _heading(diagnosis: Diagnosis) -> str:
    return f"Fitted to {Path(diagnosis.path).name}\n{' '.join(diagnosis.summary.split())}"
