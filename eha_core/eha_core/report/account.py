"""The short report of a diagnosis that a person reads on the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from textwrap import wrap

from eha_core.diagnosis.result import Diagnosis, FittedParameter, Location, NamedEffect
from eha_core.quantities import quantity, scale_for, short, within
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.claims import judged
from eha_core.report.each_recording import each_recording
from eha_core.report.finding import fitted_in_words, identified_parameters
from eha_core.report.health import fault_lines
from eha_core.report.location import location_statement
from eha_core.report.stage import compared_models, model_errors
from eha_core.report.undetected import not_missing
from eha_core.report.wording import channel_title, channels_listed, listed, span

INDENT = 13
"""Columns of the labels."""

_LONGEST = {
    "Recording": 2, "Health": 4, "Verdict": 3, "Whole": 5, "Located": 2, "Named": 2, "Recovered": 2, "Parameters": 2,
    "Not found": 2, "Next test": 3, "Note": 2,
}  # fmt: skip
_MOST_EFFECTS = 8


def account(diagnosis: Diagnosis, written: Sequence[Path] = (), width: int = 100) -> str:
    """The findings, their uncertainty, the improvement, and where the files are.

    It takes 25 lines at most, four more where channels have faults, four for each effect beyond the second, and five
    for a long record.
    """
    lines: list[str] = []
    for label, text in _findings(diagnosis):
        beyond_two = max(0, len(diagnosis.effects[:_MOST_EFFECTS]) - 2)
        lines += _section(label, text, width, 2 * beyond_two if label == "Verdict" else 0)
    lines += _improvement(diagnosis)
    lines += each_recording(diagnosis)
    lines += _section("Next test", diagnosis.next_experiment.statement if diagnosis.next_experiment else "", width)
    lines += _section("Note", "; ".join(_notes(diagnosis)), width)
    lines += files_written(written)
    return "\n".join(lines)


def _findings(diagnosis: Diagnosis) -> Iterator[tuple[str, str]]:
    yield (
        "Recording",
        f"{Path(diagnosis.path).name}: {diagnosis.duration:.1f} s of {channels_listed(diagnosis.channels)}",
    )
    yield "Health", "; ".join(fault_lines(diagnosis))
    yield "Verdict", diagnosis.summary
    for record in diagnosis.long_records:
        yield "Whole", record.statement
    for location in diagnosis.location[:1]:
        yield "Located", _located(location)
    for place, effect in enumerate(diagnosis.effects[:_MOST_EFFECTS]):
        yield "" if place else "Named", effect_in_words(effect)
    if diagnosis.unknown:
        law = diagnosis.unknown
        expression = f": {law.expression}" if law.expression else ""
        yield "Recovered", f"a law over {law.function_of}{expression} (R² {law.r_squared:.3f})"
    changed = "; ".join(_changed(parameter) for parameter in diagnosis.parameters if parameter.changed)
    yield "Parameters", f"may be biased by the missing effect: {changed}" if changed and diagnosis.biased else changed
    rivals = [
        f"{' + '.join(alternative.effects)} (evidence {alternative.evidence_gap:.1f} less)"
        for alternative in diagnosis.alternatives
    ]
    yield "Not found", not_missing(diagnosis)
    yield "Rivals", f"cannot be distinguished from {' or '.join(rivals)}" if rivals else ""


def effect_in_words(effect: NamedEffect) -> str:
    """A named effect with its values and their 95 % intervals."""
    values = [f"{name} {fitted_in_words(fitted)}" for name, fitted in identified_parameters(effect).items()]
    return f"{effect.id} ({', '.join(values)}; 95 %)"


def _changed(parameter: FittedParameter) -> str:
    return (
        f"{parameter.name} {within(parameter.fitted, parameter.std, parameter.unit)}"
        f" (nominal {quantity(parameter.nominal, parameter.unit)})"
    )


def _located(location: Location) -> str:
    spans = f"; {listed([span(interval) for interval in location.when[:4]])}" if 1 < len(location.when) <= 4 else ""
    return f"{location_statement(location)}{spans}"


def _improvement(diagnosis: Diagnosis) -> list[str]:
    """RMSE of each channel on held-out data, in a unit that suits its noise."""
    fits = judged(diagnosis)
    if not fits:
        return []
    heading = f"{'RMSE on held-out data' if diagnosis.held_out else 'RMSE':30}"
    lines = [heading + "".join(f"{column:>13}" for column in (*compared_models(diagnosis), "noise"))]
    for name, fit in list(fits.items())[:4]:
        values = (*model_errors(diagnosis, fit), fit.noise)
        scale = scale_for(CHANNEL_KINDS[name].unit, fit.noise)
        title = f"{channel_title(name)} [{scale.unit}]"
        lines.append(f"  {title:28}" + "".join(f"{short(value / scale.factor):>13}" for value in values))
    return lines


def _notes(diagnosis: Diagnosis) -> Iterator[str]:
    if diagnosis.damaged:
        yield f"damaged: {diagnosis.damaged}"
    yield from (f"not examined: {note}" for note in diagnosis.not_examined)
    yield from diagnosis.remarks


def _section(label: str, text: str, width: int, more: int = 0) -> list[str]:
    """The text beside its label, cut after its usual number of lines and `more`; the report has it all."""
    if not text:
        return []
    wrapped = _cut(text, width - INDENT, _LONGEST.get(label or "Named", 1) + more)
    return [f"{'' if row else label:{INDENT}}{line}" for row, line in enumerate(wrapped)]


def _cut(text: str, width: int, longest: int) -> list[str]:
    """At most `longest` lines: as many whole items of a list as fit, and the number of those left out; else words."""
    items = text.split("; ")
    lines = wrap(text, width)
    for kept in range(len(items) - 1, 0, -1):
        if len(lines) <= longest:
            break
        lines = wrap(f"{'; '.join(items[:kept])}; and {len(items) - kept} more", width)
    return lines if len(lines) <= longest else wrap(text, width, max_lines=longest, placeholder=" …")


def files_written(written: Sequence[Path]) -> list[str]:
    """The folders that files were written to, with their names."""
    gathered: dict[Path, list[str]] = {}
    for path in written:
        gathered.setdefault(path.parent, []).append(path.name)
    return [f"{'Written':{INDENT}}{folder}/: {', '.join(names)}" for folder, names in list(gathered.items())[:2]]
