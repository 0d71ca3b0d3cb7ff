"""Described ROS parameters: one row each, checked at the start and when they change, refused in one line."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from math import isfinite
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from eha_core.errors import EhaError, ParameterError
from eha_core.node_parameters import from_node, node_name, to_node
from eha_core.parameter import Parameter as PlantParameter
from eha_core.parameters import PAPER_PARTS
from eha_core.plant import PAPER, Composition, composition_of
from eha_core.plant.parts import parts

Value = Any  # bool, int, float, str or list of float: whatever the row's default is
_OF_EVERY_NODE = ("use_sim_time", "start_type_description_service", "qos_overrides.")


@dataclass(frozen=True)
class Row:
    """One parameter: its default, whose type is its own, meaning with unit, range, and whether it may change."""

    name: str
    default: Value
    meaning: str
    lower: float | None = None
    upper: float | None = None
    fixed: bool = False
    choices: tuple[str, ...] = ()

    def convert(self, value: object) -> Value:
        """Return the value in the parameter's type, or raise ParameterError.

        A whole number, or a number that YAML takes for text (`1e-10` has no dot), is taken where a float is asked for.
        """
        return self._check(self.typed(value))

    def typed(self, value: object) -> Value:
        """Return the value in the parameter's type, in range or not, or raise ParameterError."""
        if isinstance(self.default, list):
            return self._list(value)
        kind = type(self.default)
        if kind is float and isinstance(value, int | float | str) and not isinstance(value, bool):
            with suppress(ValueError):
                value = float(value)
        if type(value) is not kind:
            raise ParameterError(f"{self.name} = {value!r} is no {kind.__name__}; {self.meaning}")
        return value

    def _list(self, value: object) -> list[float]:
        count = len(self.default)
        if isinstance(value, Iterable) and not isinstance(value, str):
            with suppress(ValueError, TypeError):
                numbers = [float(item) for item in value]
                if len(numbers) == count:
                    return numbers
        raise ParameterError(f"{self.name} = {value!r} is no list of {count} numbers; {self.meaning}")

    def _check(self, value: Value) -> Value:
        if isinstance(value, list):
            for item in value:
                self._check(item)
            return value
        if self.choices and value not in self.choices:
            raise ParameterError(f"{self.name} = {value!r} is unknown; give one of {', '.join(self.choices)}")
        if isinstance(value, float) and not isfinite(value):
            raise ParameterError(f"{self.name} = {value} is not finite; {self.meaning}")
        bounded = isinstance(value, int | float) and self.lower is not None and self.upper is not None
        if bounded and not self.lower <= value <= self.upper:
            raise ParameterError(f"{self.name} = {value:g} is out of range; give {self.lower:g} to {self.upper:g}")
        return value

    def descriptor(self) -> ParameterDescriptor:
        """Return what `ros2 param describe` shows and rqt_reconfigure makes sliders from."""
        descriptor = ParameterDescriptor(name=self.name, description=self.meaning, read_only=self.fixed)
        descriptor.additional_constraints = f"one of {', '.join(self.choices)}" if self.choices else ""
        if self.lower is not None and self.upper is not None and isfinite(self.lower) and isfinite(self.upper):
            if isinstance(self.default, list):
                descriptor.additional_constraints = f"{len(self.default)} numbers from {self.lower:g} to {self.upper:g}"
            elif isinstance(self.default, float):
                bounds = FloatingPointRange(from_value=float(self.lower), to_value=float(self.upper), step=0.0)
                descriptor.floating_point_range = [bounds]
            else:
                whole = IntegerRange(from_value=int(self.lower), to_value=int(self.upper), step=1)
                descriptor.integer_range = [whole]
        return descriptor


def part_rows() -> list[Row]:
    """Return the ROS parameters that say which parts the plant is put together from: `plant.source` and so on."""
    return [
        Row(f"plant.{kind}", default, f"the actuator's {kind}", fixed=True, choices=tuple(parts(kind)))
        for kind, default in PAPER_PARTS.items()
    ]


def given_composition(node: Node) -> Composition:
    """Return the composition that the node was started with, or raise ParameterError."""
    return composition_of({name: given.value for name, given in node.get_parameters_by_prefix("plant").items()})


def plant_rows(values: Mapping[str, float] | None = None, composition: Composition = PAPER) -> list[Row]:
    """Return the ROS parameters of the plant, whose defaults are `values` (catalogue names), else nominal."""
    values = values or {}
    defaults = to_node({name: values.get(name, row.nominal) for name, row in composition.rows.items()})
    rows: dict[str, Row] = {}
    for name, parameter in composition.rows.items():
        rows.setdefault(node_name(name), _plant_row(node_name(name), parameter, defaults[node_name(name)]))
    return list(rows.values())


def _plant_row(name: str, parameter: PlantParameter, default: float | list[float]) -> Row:
    meaning = f"{parameter.meaning} {parameter.symbol} [{parameter.unit}]; {parameter.source}"
    if isinstance(default, list):
        meaning = f"values at the knots from `lower` to `upper` [{parameter.unit}]; {parameter.source}"
    if parameter.logarithmic:  # in the meaning, which is what rqt_reconfigure shows
        meaning += "; spans orders of magnitude: type it, by factors"
    return Row(name, default, meaning, parameter.lower, parameter.upper)


def plant_values(values: Mapping[str, Value], composition: Composition = PAPER) -> dict[str, float]:
    """Return those of a node's parameters that are the plant's, under the catalogue's names."""
    found = from_node(values)
    return {name: float(found[name]) for name in composition.rows if name in found}  # type: ignore[arg-type]


class ParameterSet:
    """The parameters of one node.

    Values given at the start (command line, parameters file) are checked before anything is declared: unknown names,
    wrong types and values out of range raise ParameterError. The node must have been made with
    `automatically_declare_parameters_from_overrides=True`, which is what brings unknown names to light.
    """

    def __init__(self, node: Node, rows: Iterable[Row]) -> None:
        self._node = node
        self._rows = {row.name: row for row in rows}
        self.values: dict[str, Value] = {row.name: row.default for row in self._rows.values()}
        given = {name: parameter.value for name, parameter in node.get_parameters_by_prefix("").items()}
        self._given = [name for name in given if not name.startswith(_OF_EVERY_NODE)]
        for name, value in self._renamed({name: given[name] for name in self._given}).items():
            if name not in self._rows:
                raise ParameterError(f"parameter {name} is unknown; `ros2 param list` shows what {node.get_name()} has")
            self.values[name] = self._rows[name].convert(value)

    def _renamed(self, given: Mapping[str, Value]) -> dict[str, Value]:
        """Take an earlier name of a plant parameter, with a warning, for the one it has now."""
        renamed: dict[str, Value] = {}
        for name, value in given.items():
            now = node_name(name)
            if name in self._rows or now not in self._rows:
                renamed[name] = value
                continue
            self._node.get_logger().warning(f"parameter {name} is now {now}; the old name will go")
            row = self._rows[now]
            if isinstance(row.default, list):
                law = renamed.setdefault(now, list(self.values[now]))
                law[int(name[-2:])] = value
            else:
                renamed[now] = value
        return renamed

    def declare(self, apply: Callable[[Mapping[str, Value]], None]) -> None:
        """Declare the parameters; from now on `apply` gets each request's changes and raises EhaError to refuse."""
        for name in self._given:
            self._node.undeclare_parameter(name)
        for name, row in self._rows.items():
            self._node.declare_parameter(name, self.values[name], row.descriptor(), ignore_override=True)
        self._apply = apply
        self._node.add_pre_set_parameters_callback(self._convert)
        self._node.add_on_set_parameters_callback(self._on_set)

    def _convert(self, parameters: list[Parameter]) -> list[Parameter]:
        converted = []
        for parameter in parameters:
            row = self._rows.get(parameter.name)
            try:
                value = row.typed(parameter.value) if row else None
            except ParameterError:
                value = None  # refused with its reason by the checks that follow
            converted.append(parameter if value is None else Parameter(parameter.name, value=value))
        return converted

    def _on_set(self, parameters: list[Parameter]) -> SetParametersResult:
        changes = {parameter.name: parameter.value for parameter in parameters if parameter.name in self._rows}
        try:
            checked = {name: self._rows[name].convert(value) for name, value in changes.items()}
            if checked:
                self._apply(checked)
        except EhaError as error:
            return SetParametersResult(successful=False, reason=str(error))
        self.values.update(checked)
        return SetParametersResult(successful=True)
