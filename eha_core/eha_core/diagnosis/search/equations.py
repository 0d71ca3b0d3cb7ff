"""Equations first: the dry friction that the force balance shows, as the start of the search."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf

from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.criteria import BARE_MENTION, HIGHER_AT_REST, MOST_OFF, MOVED, PARTS_ASKED
from eha_core.diagnosis.hypothesis import neutral
from eha_core.diagnosis.search.columns import Column, columns_of
from eha_core.effects import Effect
from eha_core.identification.observation import Observation
from eha_core.weak_form.dry_friction import CLEAR, DryFriction, dry_friction

KIND = "dry friction"


@dataclass(frozen=True)
class FrictionStart:
    """A form of dry friction with the values at which it begins, by full name."""

    effect: Effect
    values: Mapping[str, float]


@dataclass(frozen=True)
class Friction:
    """What the force balance says of dry friction.

    Attributes:
        excluded: whether there is none in it. Without both pressures, or hardly any motion between reversals, it cannot
            say that.
        held: the form that it shows clearly; None for none.
        forms: every form as it would begin, the one that is held first.
    """

    excluded: bool
    held: FrictionStart | None
    forms: tuple[FrictionStart, ...]


def friction_of(
    observations: Sequence[Observation], values: Mapping[str, float], effects: Sequence[Effect], scales: Scales
) -> Friction:
    """The dry friction of the first recording that tells it."""
    offered = {effect.id: effect for effect in effects if effect.kind == KIND}
    for observation in observations:
        found = [form for form in dry_friction(observation, values) if not form.form or form.form in offered]
        if not found:
            continue
        frictions = _of_evidence(found)
        if not frictions or _over_none(found, frictions) < CLEAR:
            excluded = _over_none(found, found) < -BARE_MENTION and not _in_a_part(observation, values)
            return Friction(excluded, None, ())
        starts = [FrictionStart(offered[form.form], _begun(offered[form.form], form, scales)) for form in frictions]
        sliding = next((form for form in frictions if form.form == "stribeck_friction"), frictions[0])
        known = {form.form for form in frictions}
        starts += [
            FrictionStart(effect, _begun(effect, sliding, scales))
            for name, effect in offered.items()
            if name not in known
        ]
        return Friction(False, starts[0], tuple(starts))
    return Friction(False, None, ())


def _over_none(found: Sequence[DryFriction], frictions: Sequence[DryFriction]) -> float:
    """By how much the criterion of the best of some forms is below that of no friction."""
    none = next(form.clear for form in found if not form.form)
    return none - min((form.clear for form in frictions if form.form), default=inf)


def _of_evidence(found: Sequence[DryFriction]) -> list[DryFriction]:
    """The forms that may be evidence of friction: one in proportion to the load is also a term of the balance's left
    side, and by itself it is none."""
    steady = [form for form in found if form.form == "coulomb_friction"]
    alone = _over_none(found, steady) < CLEAR
    return [form for form in found if form.form and not (alone and form.form == "load_friction")]


def _in_a_part(observation: Observation, values: Mapping[str, float]) -> bool:
    """Whether a part of the recording shows friction clearly: the balance of the whole hides what acts for a while."""
    edges = [observation.duration * k / PARTS_ASKED for k in range(PARTS_ASKED + 1)]
    parts = [dry_friction(observation, values, within, speeds=()) for within in pairwise(edges)]
    return any(found and _over_none(found, _of_evidence(found)) >= CLEAR for found in parts)


def friction_columns(friction: Friction) -> tuple[Column, ...]:
    """What the friction held may be off by, as columns: each of its values, and each other form in its place."""
    held, *others = friction.forms
    rows = dict(zip(held.effect.parameter_names(), held.effect.parameters, strict=True))
    own = [
        Column(held.effect, {name: (1.0 + MOVED) * held.values[name]}, (), 0, False, MOST_OFF / MOVED)
        for name, row in rows.items()
        if held.values.get(name) and (row.switches or row.relative_to == "speed")
    ]
    forms = [
        Column(other.effect, {**neutral(held.effect), **other.values}, (), number, True, 1.0)
        for number, other in enumerate(others, 1)
    ]
    return (*own, *forms)


def _begun(effect: Effect, form: DryFriction, scales: Scales) -> dict[str, float]:
    """A form's parameters, those that the force balance gives from there, the others as their guess."""
    values = dict(columns_of(effect, scales)[0].values)
    force = form.values.get("force")
    for row in effect.parameters:
        if row.name in form.values:
            values[f"{effect.id}.{row.name}"] = form.values[row.name]
        elif row.above and force:
            values[f"{effect.id}.{row.name}"] = HIGHER_AT_REST * force
    return values
