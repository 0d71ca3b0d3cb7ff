"""The fitted model's values in the result: parameters, named effects, and the values that a simulator needs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations
from types import MappingProxyType

import numpy as np

from eha_core.diagnosis.calibrate import has_changed, identifiable
from eha_core.diagnosis.criteria import COMBINED_PRECISION, IDENTIFIED
from eha_core.diagnosis.hypothesis import neutral
from eha_core.diagnosis.posterior import probability
from eha_core.diagnosis.result import FittedParameter, FittedValue, NamedEffect, ProbableSet
from eha_core.diagnosis.search.comparison import Entry
from eha_core.effects import Effect
from eha_core.identification.fit import Fit
from eha_core.identification.per_recording import base_name, is_one_of
from eha_core.identification.profile import Ends
from eha_core.parameter import Parameter
from eha_core.plant import Composition
from eha_core.quantities import Quantity


def fitted_parameters(
    final: Fit, nominal: Mapping[str, float], composition: Composition
) -> tuple[FittedParameter, ...]:
    """The plant's free parameters, each with its standard deviation and whether it has changed."""
    rows = composition.place_rows
    found = []
    for parameter in final.free:
        base = base_name(parameter.name)
        if base not in rows:
            continue
        note = (
            ""
            if identifiable(final, parameter.name)
            else "this recording does not identify it; held near its nominal value"
        )
        at_bound = parameter.is_bound_by(final.values[parameter.name])
        if at_bound:
            note = "at its prior bound: its interval is not valid"
        found.append(
            FittedParameter(
                parameter.name,
                nominal[base],
                final.values[parameter.name],
                final.deviation(parameter.name),
                rows[base].unit,
                has_changed(final, nominal, parameter.name),
                note,
                at_bound,
            )
        )
    return tuple(found)


def named_effects(
    winner: Entry,
    final: Fit,
    composition: Composition,
    sets: tuple[ProbableSet, ...],
    intervals: Mapping[str, Ends] = MappingProxyType({}),
    missed: float = 0.0,
) -> tuple[NamedEffect, ...]:
    """The named effects, each with its values, statement and probability; `intervals`: one-sided ones, of values whose
    standard deviation gives none; `missed`: the probability that the true set is none of the `sets`."""
    found = []
    for member in (member for member in winner.hypothesis.members if member.effect.named):
        effect = composition.as_shown(member.effect)
        values = {
            row.name: FittedValue(final.values[name], final.deviation(name), row.unit, intervals.get(name))
            for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)
        }
        values |= _in_other_recordings(effect, final)
        active = member.span(final.values)
        statement = _statement(effect, values) + note_on_sum_or_difference(effect, final)
        statement += f", from {active[0]:.4g} s to {active[1]:.4g} s only" if active else ""
        evidence = winner.score if len(winner.effects) == 1 else wald(final, effect)
        row = NamedEffect(
            effect.id, effect.site, effect.equation, values, evidence, statement, active, effect.kind,
            probability(sets, effect.id, missed),
        )  # fmt: skip
        found.append(row)
    return tuple(found)


def wald(result: Fit, effect: Effect) -> float:
    """The rise of chi^2 if an effect were removed, predicted by the covariance at the fit (Wald statistic)."""
    off = neutral(effect)
    switches = {f"{effect.id}.{row.name}" for row in effect.parameters if row.switches}
    names = [parameter.name for parameter in result.free if is_one_of(parameter.name, switches)]
    if not names:
        return 0.0
    distance = np.array([result.values[name] - off[base_name(name)] for name in names])
    block = result.covariance_of(names)
    scale = np.sqrt(np.maximum(np.diag(block), 1e-300))  # names differ by their unit
    correlation = np.linalg.pinv(block / np.outer(scale, scale), hermitian=True)
    return float(distance / scale @ correlation @ (distance / scale))


def _statement(effect: Effect, values: Mapping[str, FittedValue]) -> str:
    """The effect in words, with only those of its values that the recording identifies."""
    unsure = [row for row in effect.parameters if _is_unsure(values[row.name], row)]
    if len(unsure) == len(effect.parameters):
        unsure = []  # their sum or difference, if identified, is added elsewhere
    if not unsure and all(value.interval is None for value in values.values()):
        return effect.describe({name: value.value for name, value in values.items()})
    first = values[effect.parameters[0].name]
    opposite = bool(effect.opposite) and first.value < 0.0
    shown = {name: _bounded(value) for name, value in values.items()}
    shown |= {row.name: _most(values[row.name], row) for row in unsure}
    if opposite:
        low, high = first.interval or (first.value, first.value)
        magnitude = replace(first, value=-first.value, interval=(_negative(high), _negative(low)))
        shown[effect.parameters[0].name] = _bounded(magnitude)
    return (effect.opposite if opposite else effect.statement).format(**shown)


def _is_unsure(value: FittedValue, row: Parameter) -> bool:
    """Whether a fitted value cannot be distinguished from its neutral value."""
    return value.interval is None and abs(value.value - row.nominal) < IDENTIFIED * value.std < float("inf")


def _most(value: FittedValue, row: Parameter) -> Quantity:
    """The upper limit of a value's size; no number where its neutral value is not zero."""
    if row.nominal != 0.0:
        return Quantity(float("nan"), value.unit, "a value that is ")
    return Quantity(abs(value.value) + IDENTIFIED * value.std, value.unit, "at most ")


def _negative(value: float | None) -> float | None:
    return None if value is None else -value


def _bounded(value: FittedValue) -> Quantity:
    """A value, or the known end of its one-sided interval."""
    low, high = value.interval or (value.value, value.value)
    if value.value < 0.0:
        low, high = high, low
    if low is not None and high is None:
        return Quantity(low, value.unit, "at least " if value.value >= 0.0 else "at most ")
    if high is not None and low is None:
        return Quantity(high, value.unit, "at most " if value.value >= 0.0 else "at least ")
    return Quantity(value.value, value.unit)


def note_on_sum_or_difference(effect: Effect, final: Fit) -> str:
    """A note where only the difference or the sum of two values of one unit is identified; else empty."""
    rows = dict(zip(effect.parameter_names(), effect.parameters, strict=True))
    free = [parameter.name for parameter in final.free if parameter.name in rows and rows[parameter.name].switches]
    for first, second in combinations(free, 2):
        if rows[first].unit != rows[second].unit:
            continue
        block = final.covariance_of([first, second])
        alone = float(np.sqrt(max(min(block[0, 0], block[1, 1]), 0.0)))
        at = np.array([final.values[first], final.values[second]])
        uncertain = all(abs(value) < IDENTIFIED * alone for value in at)
        for word, sign in (("difference", -1.0), ("sum", 1.0)):
            weights = np.array([1.0, sign])
            together = float(np.sqrt(max(weights @ block @ weights, 0.0)))
            if uncertain and together * COMBINED_PRECISION < alone and abs(weights @ at) > IDENTIFIED * together:
                known = Quantity(float(weights @ at), rows[first].unit)
                return f" (of these two values only the {word} is known, {known:3})"
    return ""


def _in_other_recordings(effect: Effect, final: Fit) -> dict[str, FittedValue]:
    """The values of an effect's per-recording parameters in all recordings but the first: `force@2`."""
    units = {name: row.unit for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)}
    return {
        parameter.name.removeprefix(f"{effect.id}."): FittedValue(
            final.values[parameter.name], final.deviation(parameter.name), units[base_name(parameter.name)]
        )
        for parameter in final.free
        if "@" in parameter.name and is_one_of(parameter.name, units)
    }


def changed_values(final: Fit, composition: Composition) -> dict[str, float]:
    """The fitted values that differ from such an actuator's nominal ones; a simulator needs no others."""
    nominal = composition.places(composition.nominal_values())
    return {name: final.values[name] for name in nominal if final.values[name] != nominal[name]}
