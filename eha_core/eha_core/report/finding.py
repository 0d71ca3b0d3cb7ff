"""The finding as an engineer would say it: what is missing, how large, how sure, and what it is worth."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module

from eha_core.diagnosis.result import Diagnosis, NamedEffect
from eha_core.effects import SITES
from eha_core.quantities import quantity, within
from eha_core.report.claims import improvement
from eha_core.report.stage import SURE
from eha_core.report.wording import (
    VERDICT_TITLES,
    channel_title,
    effect_title,
    listed,
    sentence,
    span,
    words,
)

NEARLY_ALL = 0.9999
"""A larger share is told as more than this one, as its last digits are those of the noise."""

MOST_VALUES = 2
"""Values of one effect that the first sentence gives; the tables have all."""


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
    switching = [row.name for row in declared.parameters if row.switches and row.name in effect.parameters]
    values = []
    for name in switching[:MOST_VALUES]:
        one = effect.parameters[name]
        values.append(f"{words(name)} {within(one.value, one.std, one.unit, SURE)}")
    cause, colon, _ = effect.statement.partition(":")
    active = getattr(effect, "active", None)
    return Missing(effect_title(effect.id), tuple(values), cause if colon else "", span(active) if active else "")


def headline(diagnosis: Diagnosis) -> str:
    """The first sentence of the page."""
    if not diagnosis.effects:
        return sentence(diagnosis.summary.removeprefix(f"{VERDICT_TITLES[diagnosis.verdict]}: "))
    certain = "The model leaves out" if diagnosis.verdict == "missing_physics" else "The model most likely leaves out"
    more = "" if is_complete(diagnosis) else ", and more that is not named"
    return f"{certain} {effects_listed(diagnosis)}{more}; 95 % intervals."


def is_complete(diagnosis: Diagnosis) -> bool:
    """Whether the named effects leave nothing but noise, as far as the diagnosis says so."""
    explained = getattr(diagnosis, "explained", None)
    return explained is None or bool(explained.complete)


def effects_listed(diagnosis: Diagnosis) -> str:
    """The named effects with their values, as a sentence lists them."""
    named = [missing(effect) for effect in diagnosis.effects]
    return listed(
        [f"{one.title} ({', '.join(one.values)})" + (f" from {one.when}" if one.when else "") for one in named]
    )


def supporting(diagnosis: Diagnosis) -> tuple[str, ...]:
    """The sentences below it: the likely causes, what the physics is worth, and what it leaves."""
    causes = [(one.title, one.cause) for one in map(missing, diagnosis.effects) if one.cause]
    likely = "; ".join(f"{cause} ({title})" for title, cause in causes)
    rivals = listed([" + ".join(map(effect_title, one.effects)) for one in diagnosis.alternatives])
    changed = [one for one in diagnosis.parameters if one.changed]
    values = listed([f"{words(one.name)} {quantity(one.fitted, one.unit)}" for one in changed[:MOST_VALUES + 1]])
    found = (
        f"Likely cause{'s' if len(causes) > 1 else ''}: {likely}." if likely else "",
        f"This recording does not tell it from {rivals}." if rivals else "",
        improvement(diagnosis),
        f"Parameters that differ from the nominal model: {values}{' and others' if len(changed) > 3 else ''}."
        if changed and not diagnosis.bent
        else "",
        explanation(diagnosis),
    )
    return tuple(one for one in found if one)


def explanation(diagnosis: Diagnosis) -> str:
    """How much of the mismatch the named effects explain, and where the rest sits, where the diagnosis says so."""
    explained = getattr(diagnosis, "explained", None)
    if explained is None or not explained.times_noise or not diagnosis.effects:
        return ""
    nearly = explained.share >= NEARLY_ALL
    share = f"more than {100.0 * NEARLY_ALL:g} %" if nearly else f"{100.0 * explained.share:.4g} %"
    said = f"The named physics explains {share} of what the recalibrated model leaves beyond noise"
    if explained.complete:
        return f"{said}."
    name, most = max(explained.times_noise.items(), key=lambda item: item[1])
    sites = listed([SITES[one.site].words for one in explained.left_over])
    where = f", most likely {sites}" if sites else ""
    left = f"what is left is up to {most:.3g} times the noise, in {channel_title(name)}"
    return f"{said}; more is missing{where}: {left}."
