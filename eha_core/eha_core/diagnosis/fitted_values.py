"""The fitted model's values as the result tells them: parameters, named effects, and what a simulator needs."""

from __future__ import annotations

from collections.abc import Mapping

from eha_core.diagnosis.calibrate import has_changed, identifiable
from eha_core.diagnosis.posterior import probability
from eha_core.diagnosis.result import FittedParameter, FittedValue, NamedEffect, ProbableSet
from eha_core.diagnosis.search.prune import wald
from eha_core.diagnosis.sets.comparison import Entry
from eha_core.effects import Effect
from eha_core.identification.fit import Fit
from eha_core.identification.per_recording import base_name, is_one_of
from eha_core.plant import Composition


def fitted_parameters(
    final: Fit, nominal: Mapping[str, float], composition: Composition
) -> tuple[FittedParameter, ...]:
    """The plant's own parameters that were free, each with its deviation and whether it has changed."""
    rows = composition.place_rows
    found = []
    for parameter in final.free:
        base = base_name(parameter.name)
        if base not in rows:
            continue
        note = (
            ""
            if identifiable(final, parameter.name)
            else "this recording does not tell it; held near its nominal value"
        )
        at_bound = parameter.is_bound_by(final.values[parameter.name])
        if at_bound:
            note = "at the bound of what is believed of it: its interval does not count"
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
    winner: Entry, final: Fit, composition: Composition, sets: tuple[ProbableSet, ...]
) -> tuple[NamedEffect, ...]:
    """The effects that were named, with the values, intervals, statement and probability of each."""
    found = []
    for member in (member for member in winner.hypothesis.members if member.effect.named):
        effect = composition.as_shown(member.effect)
        values = {
            row.name: FittedValue(final.values[name], final.deviation(name), row.unit)
            for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)
        }
        values |= _in_other_recordings(effect, final)
        active = member.span(final.values)
        statement = effect.describe({name: value.value for name, value in values.items()})
        statement += f", from {active[0]:.4g} s to {active[1]:.4g} s only" if active else ""
        evidence = winner.score if len(winner.effects) == 1 else wald(final, effect)
        row = NamedEffect(
            effect.id, effect.site, effect.equation, values, evidence, statement, active, effect.kind,
            probability(sets, effect.id),
        )  # fmt: skip
        found.append(row)
    return tuple(found)


def _in_other_recordings(effect: Effect, final: Fit) -> dict[str, FittedValue]:
    """The values of an effect's parameters that differ between recordings, in all but the first: `force@2`."""
    units = {name: row.unit for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)}
    return {
        parameter.name.removeprefix(f"{effect.id}."): FittedValue(
            final.values[parameter.name], final.deviation(parameter.name), units[base_name(parameter.name)]
        )
        for parameter in final.free
        if "@" in parameter.name and is_one_of(parameter.name, units)
    }


def changed_values(final: Fit, composition: Composition) -> dict[str, float]:
    """What a simulator needs beside the nominal values of such an actuator to be the fitted plant."""
    nominal = composition.places(composition.nominal_values())
    return {name: final.values[name] for name in nominal if final.values[name] != nominal[name]}
