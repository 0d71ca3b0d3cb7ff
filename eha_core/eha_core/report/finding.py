"""The finding in sentences: what is missing, how large, how sure, and how much of the mismatch it explains."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module

from eha_core.diagnosis.result import Diagnosis, FittedParameter, FittedValue, NamedEffect
from eha_core.effects import SITES, effect_title, effects
from eha_core.quantities import bounds, quantity, within
from eha_core.report.health import fault_lines
from eha_core.report.stage import SURE
from eha_core.report.undetected import not_missing
from eha_core.report.wording import VERDICT_TITLES, channel_title, listed, plain, sentence, span, words

NEARLY_ALL = 0.9999
"""A larger share is stated as "more than" this one, because its last digits are noise."""

MOST_VALUES = 2
"""Values of one effect in the first sentence; the tables have all."""

IN_A_SENTENCE = 3
"""Most effects whose values the first sentence gives; of more it gives the names, and a table the values."""

COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight")


@dataclass(frozen=True)
class Missing:
    """One missing effect: its name, its values with 95 % intervals, the likely cause, and when it acts."""

    title: str
    values: tuple[str, ...]
    cause: str
    when: str


def missing(effect: NamedEffect) -> Missing:
    """A named effect in words."""
    declared = import_module(f"eha_core.effects.{effect.id}").EFFECT
    shown = identified_parameters(effect)
    switching = [row.name for row in declared.parameters if row.switches and row.name in shown]
    values = []
    for name in switching[:MOST_VALUES]:
        fitted = shown[name]
        values.append(f"{words(name)} {fitted_in_words(fitted)}")
    cause, colon, _ = effect.statement.partition(":")
    when = span(effect.active) if effect.active else ""
    return Missing(effect_title(effect.id), tuple(values), cause if colon else "", when)


def identified_parameters(effect: NamedEffect) -> Mapping[str, FittedValue]:
    """The parameters that the recording identifies: all but those whose interval includes a neutral zero.

    A rounded edge that may be sharp is no finding. An effect without an identified parameter keeps all of them, and so
    does a term of a law of given motion that is not in the catalogue.
    """
    declared = next((entry.parameters for entry in effects() if entry.id == effect.id), ())
    neutral = {row.name for row in declared if row.nominal == 0.0}
    shown = {
        name: fitted
        for name, fitted in effect.parameters.items()
        if name not in neutral or (fitted.value != 0.0 and not abs(fitted.value) <= SURE * fitted.std < float("inf"))
    }
    return shown or effect.parameters


def fitted_in_words(fitted: FittedValue) -> str:
    """A value with its 95 % interval, or the known end of that."""
    if fitted.interval is not None:
        return bounds(*fitted.interval, fitted.unit)
    return within(fitted.value, fitted.std, fitted.unit, SURE)


def headline(diagnosis: Diagnosis) -> str:
    """The first sentence of the page."""
    if not diagnosis.effects:
        return sentence(diagnosis.summary.removeprefix(f"{VERDICT_TITLES[diagnosis.verdict]}: "))
    certain = "The model most likely leaves out" if diagnosis.verdict == "ambiguous" else "The model leaves out"
    law = diagnosis.unknown
    beside = f", and a law over {law.function_of} that is not in the catalogue" if law else ""
    more = beside + ("" if is_complete(diagnosis) else ", and more that is not named")
    if len(diagnosis.effects) > IN_A_SENTENCE:
        return f"{certain} {counted(len(diagnosis.effects))} effects{more}: {names_listed(diagnosis)}."
    return f"{certain} {effects_listed(diagnosis)}{more}; 95 % intervals."


def counted(number: int) -> str:
    """A number as a word, where it is small."""
    return COUNTS[number] if number < len(COUNTS) else str(number)


def names_listed(diagnosis: Diagnosis) -> str:
    """The named effects without their values."""
    return listed([effect_title(effect.id) for effect in diagnosis.effects])


def is_complete(diagnosis: Diagnosis) -> bool:
    """Whether the residual with the named effects is noise."""
    return diagnosis.explained.complete or diagnosis.explained.vague


def effects_listed(diagnosis: Diagnosis) -> str:
    """The named effects with their values, as a sentence lists them."""
    named = [missing(effect) for effect in diagnosis.effects]
    return listed(
        [
            f"{absent.title} ({', '.join(absent.values)})" + (f" from {absent.when}" if absent.when else "")
            for absent in named
        ]
    )


def warnings(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Warnings above all findings: implausible data that were accepted, a damaged file, gaps and faults of channels."""
    doubts = [remark for remark in diagnosis.remarks if "warning: " in remark]
    # with several recordings, a remark begins with its recording's path
    shown = [sentence(remark) if remark.startswith("warning") else f"{remark}." for remark in doubts]
    damaged = f"Warning: the file is damaged, and this rests on what could be read: {diagnosis.damaged}."
    faults = (sentence(plain(line)) for line in fault_lines(diagnosis))
    return (*shown, *([damaged] if diagnosis.damaged else ()), *faults)


def supporting(diagnosis: Diagnosis) -> tuple[str, ...]:
    """The sentences below the headline: likely causes, changed parameters, and the explained share of the mismatch."""
    causes = [(absent.title, absent.cause) for absent in map(missing, diagnosis.effects) if absent.cause]
    likely = "; ".join(f"{cause} ({title})" for title, cause in causes)
    rivals = listed([" + ".join(map(effect_title, alternative.effects)) for alternative in diagnosis.alternatives])
    changed = [parameter for parameter in diagnosis.parameters if parameter.changed]
    shown = changed[: MOST_VALUES + 1]
    values = listed([f"{words(parameter.name)} {_departure(parameter)}" for parameter in shown])
    found = (
        f"Likely cause{'s' if len(causes) > 1 else ''}: {likely}." if likely else "",
        f"In this recording it cannot be distinguished from {rivals}." if rivals else "",
        f"Parameters that differ from the nominal model: {values}{' and others' if len(changed) > len(shown) else ''}."
        if changed and not diagnosis.biased
        else "",
        explanation(diagnosis),
        sentence(not_missing(diagnosis)),
        *(record.statement for record in diagnosis.long_records),
    )
    return tuple(text for text in found if text)


def _departure(parameter: FittedParameter) -> str:
    """A changed parameter's value, and how far it is from nominal."""
    value = quantity(parameter.fitted, parameter.unit)
    return (
        f"{value} ({parameter.fitted / parameter.nominal - 1.0:+.1%})".replace("%", " %")
        if parameter.nominal
        else value
    )


def explanation(diagnosis: Diagnosis) -> str:
    """How much of the mismatch the named effects explain, and the likely sites of the rest; empty if not known."""
    explained = diagnosis.explained
    if not explained.times_noise or not diagnosis.effects:
        return ""
    nearly = explained.share >= NEARLY_ALL
    share = f"more than {100.0 * NEARLY_ALL:g} %" if nearly else f"{100.0 * explained.share:.4g} %"
    said = f"The named physics explains {share} of the recalibrated model's error beyond the noise"
    if explained.complete:
        return f"{said}."
    if explained.vague:
        return f"{said}; the recording does not determine how strong each effect is."
    name, most = max(explained.times_noise.items(), key=lambda item: item[1])
    sites = listed([SITES[location.site].words for location in explained.left_over])
    where = f", most likely {sites}" if sites else ""
    left = f"the residual is up to {most:.3g} times the noise, in {channel_title(name)}"
    return f"{said}; more is missing{where}: {left}."
