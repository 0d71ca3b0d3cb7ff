"""A parameters file read whole: which parts the actuator has, and what their parameters are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from eha_core.errors import ParameterError, remedy
from eha_core.parameters import PAPER_PARTS, PER_RECORDING, read_section, refuse_unknown, split_parts
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


def voltage_driven(path: str | Path) -> dict[str, float]:
    """Every parameter of the equations, for a reader that knows an actuator on a voltage whose piston slides.

    Raises ParameterError as `load_plant` does, and as `require_voltage`.
    """
    found = load_plant(path)
    require_voltage(found.composition, f"{path}: ")
    return found.places


def require_voltage(composition: Composition, where: str = "") -> None:
    """Raise ParameterError for an actuator that no voltage drives, or whose piston does not slide."""
    for kind, one, taken in (
        ("source", composition.source, composition.source.valve == "coil"),
        ("cylinder", composition.cylinder, composition.cylinder.motion == "m"),
    ):
        if not taken:
            raise ParameterError(f"{where}plant.{kind} = {one.id} is not taken here; `eha simulate` takes it")


def composition_of(section: Mapping[str, object]) -> Composition:
    """The composition that a section `plant` with `source`, `cylinder` and `load`, or some of them, names."""
    unknown = [name for name in section if name not in PAPER_PARTS]
    if unknown:
        raise ParameterError(f"plant.{unknown[0]} is unknown; {remedy(unknown[0], PAPER_PARTS)}")
    return compose(**{name: str(value) for name, value in section.items()})


