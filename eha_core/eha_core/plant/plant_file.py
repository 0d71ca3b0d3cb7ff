"""A parameters file read whole: which parts the actuator has, and what their parameters are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from eha_core.errors import ParameterError, remedy
from eha_core.parameters import (
    PAPER_PARTS,
    PER_RECORDING,
    dump_parameters,
    read_section,
    refuse_unknown,
    split_parts,
)
from eha_core.plant.composition import Composition, compose


@dataclass(frozen=True)
class GivenPlant:
    """A composition, and those of its parameters that a file gives, in the names of its parts."""

    composition: Composition
    values: Mapping[str, float]

    @property
    def places(self) -> dict[str, float]:
        """Every parameter of the equations: what the diagnosis and the lock-step take."""
        whole = self.composition
        return whole.places(whole.changed(whole.nominal_values(), self.values))


def load_plant(path: str | Path) -> GivenPlant:
    """Read a parameters file in ROS 2's YAML form, with the parts that it names under `plant:`.

    Raises ParameterError naming the file: it cannot be read, a part is unknown, a value does not fit, or a parameter
    does not apply to these parts.
    """
    values, section = split_parts(read_section(path))
    values.pop(PER_RECORDING, None)
    refuse_unknown(path, values)
    try:
        made = composition_of(section)
        complete = made.changed(made.nominal_values(), values)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error
    return GivenPlant(made, {name: complete[name] for name in values})


def dump_plant(places: Mapping[str, float], composition: Composition, heading: str = "") -> str:
    """The text of a file that `load_plant` reads, of some parameters of the equations; `heading` as its comment."""
    values = {name: places[composition.stands_for(name)[0]] for name in composition.rows
              if composition.stands_for(name)[0] in places}  # fmt: skip
    if composition.is_papers:
        return dump_parameters(places, heading)
    parts = ", ".join(f"{kind}: {name}" for kind, name in composition.names.items())
    first, parameters = dump_parameters(values, heading).split("  ros__parameters:\n")
    return f"{first}  ros__parameters:\n    plant: {{{parts}}}\n{parameters}"


def voltage_driven(path: str | Path) -> dict[str, float]:
    """Every parameter of the equations, for a reader that knows an actuator on a voltage whose piston slides.

    Raises ParameterError as `load_plant` does, and as `require_voltage`.
    """
    found = load_plant(path)
    try:
        require_voltage(found.composition)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error
    return found.places


def require_voltage(composition: Composition) -> None:
    """Raise ParameterError for an actuator that no voltage drives, or whose piston does not slide."""
    if composition.source.valve != "coil":
        raise ParameterError(f"plant.source = {composition.source.id} is not taken here; `eha simulate` takes it")
    require_sliding(composition)


def require_sliding(composition: Composition) -> None:
    """Raise ParameterError for an actuator that turns."""
    if composition.cylinder.motion != "m":
        raise ParameterError(f"plant.cylinder = {composition.cylinder.id} is not taken here; `eha simulate` takes it")


def composition_of(section: Mapping[str, object]) -> Composition:
    """The composition that a section `plant` with `source`, `cylinder` and `load`, or some of them, names."""
    unknown = [name for name in section if name not in PAPER_PARTS]
    if unknown:
        raise ParameterError(f"plant.{unknown[0]} is unknown; {remedy(unknown[0], PAPER_PARTS)}")
    return compose(**{name: str(value) for name, value in section.items()})
