"""The model that recordings are held against: its values, which of them nobody knows, and which differ by recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from eha_core.errors import ParameterError
from eha_core.node_parameters import from_node
from eha_core.parameters import PER_RECORDING, UNKNOWN, acting_as, effect_names, is_unknown, read_section, split_parts
from eha_core.plant import PAPER, Composition, composition_of


@dataclass(frozen=True)
class NominalModel:
    """A complete set of parameters, and how far it is known.

    Attributes:
        values: every parameter of the catalogue by name [SI]; the catalogue's own value for the unknown ones.
        unknown: names of the plant's parameters whose value nobody knows.
        per_recording: names of the parameters that differ between recordings of one rig, in the order given.
        composition: the actuator's parts. The names are those of the equations, `Composition.places`.
    """

    values: Mapping[str, float]
    unknown: frozenset[str] = frozenset()
    per_recording: tuple[str, ...] = ()
    composition: Composition = PAPER


def load_nominal(path: str | Path) -> NominalModel:
    """Read a nominal file: a parameters file in ROS 2's YAML form in which a value may be `unknown`.

    `per_recording: [names]` stands at the top of the file or among the simulator's parameters.

    Raises:
        ParameterError: naming the file, where it cannot be read, or what `nominal_of` refuses.
    """
    given, parts = split_parts(read_section(path))
    per_recording = given.pop(PER_RECORDING, None)
    try:
        return nominal_of(given, per_recording, composition_of(parts))
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error


def nominal_of(
    given: Mapping[str, object], per_recording: object = None, composition: Composition = PAPER
) -> NominalModel:
    """The nominal model of values by name, each a number [SI] or `unknown`; the rest is the catalogue's.

    Args:
        given: values by catalogue name, or in the names of the composition's parts.
        per_recording: a list of names that differ between recordings; None where none does.
        composition: the actuator's parts.

    Raises:
        ParameterError: a name that does not exist, a value that does not fit, or an effect that is said to be unknown.
    """
    unknown = [name for name, value in given.items() if is_unknown(value)]
    for name in unknown:
        composition.require(name)
        if name in effect_names():
            raise ParameterError(
                f"{name} is {UNKNOWN}, which a diagnosis of effects finds out by itself; leave it out, or give a value"
            )
    known = {name: value for name, value in given.items() if name not in unknown}
    values = composition.places(composition.changed(composition.nominal_values(), known))
    places = (place for name in unknown for place in composition.stands_for(name))
    return NominalModel(values, frozenset(places), _names(per_recording, composition), composition)


def _names(listed: object, composition: Composition) -> tuple[str, ...]:
    """The names that `per_recording` lists, each once and under that of its place in the equations."""
    if listed is None:
        return ()
    if not isinstance(listed, (list, tuple)) or not all(isinstance(name, str) for name in listed):
        raise ParameterError(f"{PER_RECORDING} = {listed!r} is no list of names; write for example [supply_pressure]")
    names = tuple(dict.fromkeys(found for name in listed for found in from_node({name: 0.0})))
    for name in names:
        composition.require(name, f"{PER_RECORDING}: ")
    return tuple(place for name in names for place in (*acting_as(name), *composition.stands_for(name)))
