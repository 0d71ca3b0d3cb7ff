"""A rig as a model and its departures from it: the effects found, an increased leakage, and other parameters."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_core.diagnosis.hypothesis import neutral
from eha_core.effects import Effect, effects
from eha_core.errors import EhaError
from eha_core.parameters import effect_names
from eha_core.plant import PAPER, Composition
from eha_core.plant.fitted import fitted_plant
from eha_core.plant.plant_file import require_voltage
from eha_core.quantities import quantity

Array = NDArray[np.float64]

LEAKAGES = ("internal_leakage", "external_leakage")
"""Parameters of the model that wear increases and new seals reduce: each is a departure, and is repaired, by itself."""

LEAKAGE_UNIT = "m^3/(s Pa)"

PARAMETERS = "parameters"
"""The departure of all other parameters together. They belong to the rig, and no repair changes them."""

MOST = 10
"""Most departures, since every subset is simulated: 1,024 closed loops take some seconds."""


@dataclass(frozen=True)
class Departure:
    """One difference of the rig from its model.

    Attributes:
        name: an effect's id, one of LEAKAGES, or PARAMETERS.
        statement: the difference in words.
        values: parameters (SI, by their names in the equations) with it.
        absent: the same parameters without it.
        repairable: whether a repair removes it.
    """

    name: str
    statement: str
    values: Mapping[str, float]
    absent: Mapping[str, float]
    repairable: bool = True


@dataclass(frozen=True)
class Rig:
    """A rig as its model and its departures from that.

    Attributes:
        source: where it was read.
        modelled: every parameter of the equations as modelled, all effects off [SI].
        departures: at most MOST.
        deviations: standard deviations [SI] of the departures' values as far as they are known, by name.
        correlation: (n, n) of the errors of those values, in the order of `deviations`.
        remarks: assumptions, in sentences.
        composition: the actuator's parts.
    """

    source: str
    modelled: Mapping[str, float]
    departures: tuple[Departure, ...]
    deviations: Mapping[str, float]
    correlation: Array
    remarks: tuple[str, ...] = ()
    composition: Composition = PAPER

    def values(self, present: Iterable[Departure]) -> dict[str, float]:
        """Every parameter of the rig with only these departures."""
        found = dict(self.modelled)
        for departure in present:
            found |= departure.values
        return found


def rig_from_changes(
    changes: Mapping[str, float], modelled: Mapping[str, float], composition: Composition = PAPER, source: str = "given"
) -> Rig:
    """A rig whose departures from the model (`modelled`, every parameter of the equations) are given by name.

    Raises ParameterError for a wrong name or value, EhaError without a departure or with too many.
    """
    require_voltage(composition)
    composition.changed(composition.nominal_values(), changes)
    given = {place: value for name, value in changes.items() for place in composition.stands_for(name)}
    departures = _departures(source, modelled, {**modelled, **given}, [name for name in LEAKAGES if name in given], {})
    return Rig(source, dict(modelled), departures, {}, np.empty((0, 0)), (), composition)


def rig_from_document(document: Mapping[str, Any], source: str) -> Rig:
    """The rig of a diagnosis, from the content of `diagnosis.json`; with several recordings, with the first's values.

    Raises EhaError where it is no such document, or where no departure was found.
    """
    composition, fitted = fitted_plant(document, source)
    require_voltage(composition)
    rows = {row["name"]: row for row in document["parameters"] if "@" not in row["name"]}
    modelled = {**fitted, **_all_off(), **{name: row["nominal"] for name, row in rows.items()}}
    leaks = [name for name in LEAKAGES if name in rows and rows[name]["changed"]]
    statements = {effect["id"]: effect["statement"] for effect in document["effects"]}
    departures = _departures(source, modelled, fitted, leaks, statements)
    deviations, correlation = _uncertainty(document, departures)
    remarks = (*_remarks(document), *_vague(departures, deviations))
    return Rig(source, modelled, departures, deviations, correlation, remarks, composition)


def _departures(
    source: str, modelled: Mapping[str, float], fitted: Mapping[str, float], leaks: Sequence[str],
    statements: Mapping[str, str],
) -> tuple[Departure, ...]:  # fmt: skip
    """The departures of the fitted from the modelled values; those of LEAKAGES in `leaks` count by themselves."""
    found = [_of_effect(effect, fitted, statements) for effect in effects() if effect.is_active(fitted)]
    for name in leaks:
        statement = f"{name.replace('_', ' ')} is {quantity(fitted[name], LEAKAGE_UNIT)}"
        statement += f", modelled as {quantity(modelled[name], LEAKAGE_UNIT)}"
        found.append(Departure(name, statement, {name: fitted[name]}, {name: modelled[name]}))
    if not found:
        raise EhaError(f"{source}: no effect and no changed leakage is named, so there is nothing to repair")
    own = {name: value for name, value in fitted.items()
           if name not in {*effect_names(), *leaks} and value != modelled[name]}  # fmt: skip
    if own:
        absent = {name: modelled[name] for name in own}
        found.append(Departure(PARAMETERS, f"other values of {', '.join(own)}", own, absent, False))
    if len(found) > MOST:
        raise EhaError(f"{source}: {len(found)} departures have {2 ** len(found)} subsets; a budget takes {MOST}")
    return tuple(found)


def _of_effect(effect: Effect, fitted: Mapping[str, float], statements: Mapping[str, str]) -> Departure:
    """The departure of an effect, which always acts here: the recording's times are not those of the task."""
    absent = neutral(effect)
    values = {**absent, **{name: fitted[name] for name in effect.parameter_names()}}
    for name, row in zip(effect.parameter_names(), effect.parameters, strict=True):
        if row.relative_to == "time" and not row.logarithmic:
            values[name] = row.lower
    described = "a recovered law that is not in the catalogue"
    if effect.named:
        described = effect.describe({row.name: values[f"{effect.id}.{row.name}"] for row in effect.parameters})
    return Departure(effect.id, statements.get(effect.id, described), values, absent)


def _uncertainty(document: Mapping[str, Any], departures: Sequence[Departure]) -> tuple[dict[str, float], Array]:
    """The known standard deviations of the departures' values, and their correlation."""
    known = {row["name"]: row["std"] for row in document["parameters"]}
    for effect in document["effects"]:
        known |= {f"{effect['id']}.{name}": row["std"] for name, row in effect["parameters"].items()}
    correlated = document["correlation"] or {"names": [], "matrix": []}
    of_rig = {name for departure in departures for name in departure.values}
    places = [place for place, name in enumerate(correlated["names"]) if name in of_rig and known.get(name)]
    matrix = np.array(correlated["matrix"], dtype=np.float64).reshape(len(correlated["names"]), -1)
    names = [correlated["names"][place] for place in places]
    return {name: known[name] for name in names}, matrix[np.ix_(places, places)]


def _remarks(document: Mapping[str, Any]) -> Iterator[str]:
    for effect in document["effects"]:
        if effect["active"]:
            begin, end = effect["active"]
            yield f"{effect['id']} acted from {begin:.4g} s to {end:.4g} s of the recording; here it always acts"
    if document["alternatives"]:
        others = " or ".join(" + ".join(row["effects"]) for row in document["alternatives"])
        yield f"the recording cannot distinguish the effects from {others}; the budget is of those that were named"


def _vague(departures: Sequence[Departure], deviations: Mapping[str, float]) -> Iterator[str]:
    for departure in departures:
        if departure.repairable and not set(departure.values) & set(deviations):
            yield f"the uncertainty of {departure.name} is not known and not counted"


def _all_off() -> dict[str, float]:
    """The values at which no effect of the catalogue acts."""
    return {name: value for effect in effects() for name, value in neutral(effect).items()}
