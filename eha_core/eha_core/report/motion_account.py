"""The report on the terminal of a law of given motion: what is certain, what remains, what to record next, details."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from textwrap import wrap

from eha_core.diagnosis.result import ChannelFit, PredictedRecording
from eha_core.motion_given import Found
from eha_core.quantities import quantity
from eha_core.report.account import INDENT, effect_in_words, files_written
from eha_core.report.wording import channels_listed


def motion_account(found: Found, written: Sequence[Path] = (), width: int = 100) -> str:
    """The findings, each prediction of a test, every remark as a whole, and where the files are."""
    lines: list[str] = []
    for label, text in _sections(found):
        wrapped = wrap(text, width - INDENT)
        lines += [f"{'' if row else label:{INDENT}}{line}" for row, line in enumerate(wrapped)]
    return "\n".join([*lines, *files_written(written)])


def _sections(found: Found) -> Iterator[tuple[str, str]]:
    diagnosis, sentences = found.diagnosis, found.sentences
    more = f" and {len(found.motions) - 1} more" if len(found.motions) > 1 else ""
    yield (
        "Recording",
        f"{Path(diagnosis.path).name}{more}: {diagnosis.duration:.1f} s of {channels_listed(diagnosis.channels)}",
    )
    yield "Certain", sentences.certain
    yield "Remains", sentences.remains
    yield "Next", sentences.next_recording
    for place, effect in enumerate(diagnosis.effects):
        yield "" if place else "Named", effect_in_words(effect)
    yield "Fitted", _error(diagnosis.training["force"])
    for test in diagnosis.tests:
        yield "Test", f"{Path(test.path).name}: {_test_error(test)}"
    if diagnosis.damaged:
        yield "Damaged", diagnosis.damaged
    for place, note in enumerate((*(f"not examined: {one}" for one in diagnosis.not_examined), *diagnosis.remarks)):
        yield "" if place else "Note", note


def _error(fit: ChannelFit) -> str:
    return _in_words(fit.rmse_before, fit.rmse_calibrated, fit.rmse_after)


def _test_error(test: PredictedRecording) -> str:
    mean, line, law = (test.prediction[one]["force"].free_running for one in ("nominal", "recalibrated", "augmented"))
    return _in_words(mean, line, law)


def _in_words(deviation: float, line: float, law: float) -> str:
    """The law's RMSE against the force's deviation and against viscous friction with a load."""
    share = f", {100.0 * law / deviation:.1f} % of the force's deviation" if deviation > 0.0 else ""
    return f"RMSE {quantity(law, 'N')}{share}; viscous friction with a load alone {quantity(line, 'N')}"
