"""What is exported: the plant's parts, the values it starts with, and its variables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from eha_core.effects import effects
from eha_core.parameter import Parameter
from eha_core.plant import PAPER, Composition, load_plant
from eha_core.plant.fitted import fitted_plant, read_diagnosis
from eha_core.plant.plant_file import require_voltage
from eha_core.plant.simulator import check_step_size

OUTPUTS = {
    "voltage": ("V", "voltage in the last step"),
    "current": ("A", "coil current"),
    "spool_position": ("A", "spool position, ampere-equivalent: it settles at the current"),
    "spool_velocity": ("A/s", "spool rate, ampere-equivalent"),
    "position": ("m", "piston position from mid stroke"),
    "velocity": ("m/s", "piston velocity"),
    "pressure_a": ("Pa", "chamber A, above the return line's reference"),
    "pressure_b": ("Pa", "chamber B, above the return line's reference"),
    "flow_a": ("m^3/s", "valve flow into chamber A"),
    "flow_b": ("m^3/s", "valve flow out of chamber B"),
    "internal_leakage_flow": ("m^3/s", "from chamber A to chamber B"),
    "external_leakage_flow_a": ("m^3/s", "out of chamber A to the outside"),
    "external_leakage_flow_b": ("m^3/s", "out of chamber B to the outside"),
    "supply_pressure": ("Pa", "supply pressure at the valve"),
    "return_pressure": ("Pa", "return pressure at the valve"),
    "hydraulic_force": ("N", "pressure force on the piston"),
    "friction_force": ("N", "friction on the piston, with the reaction of the stroke's ends"),
    "internal_leakage": ("m^3/(s Pa)", "leakage coefficient in force"),
    "measured_position": ("m", "position sensor"),
    "measured_velocity": ("m/s", "velocity sensor"),
    "measured_pressure_a": ("Pa", "pressure sensor of chamber A, above the return line's reference"),
    "measured_pressure_b": ("Pa", "pressure sensor of chamber B, above the return line's reference"),
}
"""Unit and meaning of each column of `eha_core.plant.COLUMNS`."""


@dataclass(frozen=True)
class Variable:
    """One variable of an FMU. `causality` is FMI's: parameter, input, output or independent; of a parameter, `tunable`
    says that it may change while the plant runs. `start` is None for what the plant calculates."""

    name: str
    unit: str
    meaning: str
    causality: str
    start: float | None = None
    lower: float | None = None
    upper: float | None = None
    tunable: bool = False


@dataclass(frozen=True)
class ExportedModel:
    """A plant on a voltage: its parts, every parameter under the names of its parts [SI], and its step [s].

    Raises ParameterError for a source that no voltage drives, a piston that does not slide, values that make no plant,
    and a step that is not 1e-6 to 1e-3 s.
    """

    composition: Composition
    values: Mapping[str, float]
    step_size: float = 1e-4

    def __post_init__(self) -> None:
        require_voltage(self.composition)
        check_step_size(self.step_size)
        self.composition.changed(self.composition.nominal_values(), self.values)

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """The parameters, by name, in the order in which the exported plant numbers them."""
        return self.composition.rows

    @property
    def acting(self) -> list[str]:
        """The effects that act, by id."""
        places = self.composition.places(self.values)
        return [effect.id for effect in effects() if effect.is_active(places)]

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """Every variable; each has its place here as FMI's value reference."""
        found = [
            Variable(name, row.unit, row.meaning, "parameter", self.values[name], row.lower, row.upper, tunable=True)
            for name, row in self.parameters.items()
        ]
        taken = {variable.name for variable in found}
        # three columns are called as the parameters that they follow
        found += [
            Variable(f"{name}_in_force" if name in taken else name, unit, meaning, "output")
            for name, (unit, meaning) in OUTPUTS.items()
        ]
        return (
            *found,
            Variable("voltage_command", "V", "valve voltage, held over each communication step", "input", 0.0),
            Variable("initial_position", "m", "where the piston starts", "parameter", 0.0),
            Variable("time", "s", "time", "independent"),
        )


def exported_model(
    nominal: str | Path | None = None, diagnosis: str | Path | None = None, step_size: float = 1e-4
) -> ExportedModel:
    """The model of a parameters file, of a diagnosis.json with all that was found, or else the nominal plant.

    Raises EhaError, naming the file, where it cannot be used; see `ExportedModel`.
    """
    if diagnosis is not None:
        composition, places = fitted_plant(read_diagnosis(diagnosis), str(diagnosis))
        return ExportedModel(composition, composition.named(places), step_size)
    if nominal is not None:
        given = load_plant(nominal)
        return ExportedModel(given.composition, {**given.composition.nominal_values(), **given.values}, step_size)
    return ExportedModel(PAPER, PAPER.nominal_values(), step_size)
