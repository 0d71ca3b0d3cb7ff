"""The nominal plant's parameters, the whole catalogue of them, and parameter files.

Sources: "Table 1" and "Table 2" are of Shern, Ghazali, Soon, Sam, Rahmat, "Position Tracking Performance for
Electro-Hydraulic Actuator System with the Presence of Actuator Internal Leakage".
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType

from eha_core.effects import Effect, effects
from eha_core.errors import ParameterError, remedy
from eha_core.node_parameters import from_node, to_node
from eha_core.parameter import Parameter
from eha_core.yaml_file import load_yaml


def _row(
    name: str, symbol: str, unit: str, nominal: float, bounds: tuple[float, float], meaning: str,
    source: str = "Table 1", logarithmic: bool = True,
) -> Parameter:  # fmt: skip
    lower, upper = bounds
    return Parameter(
        name=name, symbol=symbol, unit=unit, nominal=nominal, lower=lower, upper=upper, meaning=meaning, source=source,
        typical=nominal, logarithmic=logarithmic,
    )  # fmt: skip


NOMINAL: tuple[Parameter, ...] = (
    _row("coil_resistance", "R_c", "ohm", 100.0, (1.0, 1e4), "resistance of the torque motor's coil"),
    _row("coil_inductance", "L_c", "H", 0.59, (1e-3, 100.0), "inductance of the torque motor's coil"),
    _row("saturation_current", "I_sat", "A", 0.02, (1e-4, 1.0), "current at which the coil's drive saturates"),
    _row("valve_damping_ratio", "xi", "-", 0.48, (0.05, 5.0), "damping ratio of the servo valve's spool"),
    _row("valve_natural_frequency", "w", "rad/s", 543.0, (10.0, 1e4), "natural frequency of the servo valve's spool"),
    _row("valve_gain", "K", "m^(5/2) kg^(-1/2)", 2.38e-5, (1e-8, 1e-2), "flow gain of the valve per ampere-equivalent"),
    _row("bulk_modulus", "beta", "Pa", 1.4e9, (1e7, 1e10), "effective bulk modulus of the oil"),
    _row("supply_pressure", "P_s", "Pa", 2.1e7, (1e5, 1e8), "supply pressure above the return line's reference"),
    _row("return_pressure", "P_r", "Pa", 0.0, (0.0, 1e7), "return pressure above the reference", logarithmic=False),
    _row("spring_stiffness", "K_s", "N/m", 10.0, (0.0, 1e8), "stiffness of the spring that the load works against",
         'Table 1, which prints "Nm"', logarithmic=False),
    _row("actuator_displacement", "x_s", "m", 0.1, (1e-3, 10.0), "stroke to either side of the middle"),
    _row("piston_area", "A_p", "m^2", 645e-6, (1e-6, 1.0), "piston area towards chamber A"),
    _row("piston_area_b", "A_b", "m^2", 645e-6, (1e-6, 1.0), "piston area towards chamber B",
         "Table 1: the paper's cylinder is symmetric"),
    _row("moving_mass", "M_p", "kg", 9.0, (1e-2, 1e5), "mass of piston and load"),
    _row("damping_coefficient", "B_s", "N s/m", 2000.0, (0.0, 1e7), "viscous damping of piston and load"),
    _row("internal_leakage", "K_Lin", "m^3/(s Pa)", 1e-12, (0.0, 1e-7), "laminar leakage between the chambers",
         "Table 2, level 1", logarithmic=False),
    _row("external_leakage", "K_Lex", "m^3/(s Pa)", 0.0, (0.0, 1e-7), "laminar leakage of each chamber to the outside",
         logarithmic=False),
    _row("line_volume", "V_line", "m^3", 1e-5, (1e-7, 1e-1), "oil between each port and its chamber's end",
         "assumed: the paper gives none"),
    _row("atmospheric_pressure", "P_atm", "Pa", 101325.0, (0.0, 2e5),
         "absolute pressure of the return line's reference", "standard atmosphere", logarithmic=False),
)  # fmt: skip

ACTING: tuple[Parameter, ...] = (
    _row("effects_from", "t_from", "s", 0.0, (0.0, 1e9), "time from which the catalogue's effects act", "assumed",
         logarithmic=False),
    _row("effects_until", "t_until", "s", 1e9, (0.0, 1e9), "time from which they no longer act", "assumed",
         logarithmic=False),
)  # fmt: skip
"""The span of time in which whatever effects are switched on act: by their nominal values always."""

_ACTS = (
    _row("acts_from", "t_from", "s", 0.0, (0.0, 1e9), "time from which the effect acts", "assumed", logarithmic=False),
    _row("acts_until", "t_until", "s", 1e9, (0.0, 1e9), "time from which it no longer acts", "assumed",
         logarithmic=False),
)  # fmt: skip


def acting_rows(effect: Effect) -> dict[str, Parameter]:
    """When an effect acts of that in which all may: by their nominal values always."""
    return dict(zip(effect.acting_names(), _ACTS, strict=False))


def acting_as(name: str) -> tuple[str, ...]:
    """Each effect's own instant of the kind that a parameter of ACTING is for all of them; none for another name."""
    kinds = [row.name for row in ACTING]
    if name not in kinds:
        return ()
    return tuple(effect.acting_names()[kinds.index(name)] for effect in effects() if effect.named)


@cache
def step_rows() -> Mapping[str, Parameter]:
    """The parameters that the compiled step takes, in its order: the nominal rows, and each effect's own."""
    rows = {row.name: row for row in NOMINAL}
    for effect in effects():
        rows.update(zip(effect.parameter_names(), effect.parameters, strict=True))
    return MappingProxyType(rows)


@cache
def catalogue() -> Mapping[str, Parameter]:
    """Every parameter of the plant by its full name: the nominal rows, each effect's as `<effect id>.<name>`, the span
    of time in which the effects act, and that of each."""
    rows = {**step_rows(), **{row.name: row for row in ACTING}}
    for effect in effects():
        rows.update(acting_rows(effect))
    return MappingProxyType(rows)


@cache
def effect_names() -> frozenset[str]:
    """The parameters that are of effects, and of when they act."""
    return frozenset(catalogue()) - {row.name for row in NOMINAL}


def nominal_values() -> dict[str, float]:
    """The nominal plant: every parameter at its nominal value, every effect off."""
    return {name: row.nominal for name, row in catalogue().items()}


def changed(values: Mapping[str, float], changes: Mapping[str, object]) -> dict[str, float]:
    """Return `values` with `changes` applied, checked as a whole.

    Raises ParameterError for an unknown name, a value that is no finite number within its bounds, or a set that makes
    no plant; `values` is left as it was.
    """
    result = dict(values)
    for name, value in changes.items():
        row = catalogue().get(name)
        if row is None:
            what_to_do = remedy(name, catalogue(), "`eha effects --parameters` lists the names")
            raise ParameterError(f"there is no parameter named {name}; {what_to_do}")
        result[name] = row.check(value, name)
    check_supply(result)
    return result


def check_supply(values: Mapping[str, float]) -> None:
    """Raise ParameterError where the supply's pressure, if there is one, does not exceed the return line's."""
    if "supply_pressure" in values and values["supply_pressure"] <= values["return_pressure"]:
        raise ParameterError(
            f"supply_pressure = {values['supply_pressure']:g} Pa must exceed "
            f"return_pressure = {values['return_pressure']:g} Pa; change both together"
        )


PAPER_PARTS = {"source": "servo_valve", "cylinder": "double_rod", "load": "sprung_mass"}
"""The parts of the paper's actuator, as a file names them under `plant:`; see `eha_core.plant.parts`."""
PART = "plant."
"""What begins their names where nested keys are joined by dots."""

NODE_KEYS = ("/**", "/**/eha_sim", "eha_sim", "/eha_sim")
"""Under these keys a ROS parameters file speaks to the simulator; the more particular ones overrule the others."""

NODE_ONLY = frozenset(
    {"use_sim_time", "step_size", "publish_rate", "clock_rate", "time_mode", "real_time_factor", "lockstep_patience",
     "command_timeout", "command_limit", "catch_up_limit", "initial_position", "start_paused", "frame_id",
     "diagnostics_rate", "qos_overrides", "start_type_description_service"}
)  # fmt: skip
"""Parameters of the simulator node that are none of the plant's; a parameters file may carry them."""


UNKNOWN = "unknown"
"""What a nominal file says in place of a value that nobody knows."""
PER_RECORDING = "per_recording"
"""Key of a nominal file's list of the parameters that differ between recordings of one rig."""


def is_unknown(value: object) -> bool:
    """Whether a parameters file's value is the word `unknown`."""
    return isinstance(value, str) and value.strip().lower() == UNKNOWN


def read_section(path: str | Path) -> dict[str, object]:
    """What a parameters file in ROS 2's YAML form says to the simulator, under the catalogue's names and unchecked.

    Nested keys are joined by dots. Sections of other nodes and the node's own settings are passed over. A number in
    any spelling is a number.

    Raises:
        ParameterError: the file cannot be read, or says nothing to the simulator.
    """
    document = load_yaml(path, ParameterError, str(path))
    if not isinstance(document, dict):
        raise ParameterError(f"{path}: expected `eha_sim: {{ros__parameters: {{...}}}}` at the top")
    found: dict[str, object] = {}
    for key in NODE_KEYS:
        section = document.get(key)
        if isinstance(section, dict) and isinstance(section.get("ros__parameters"), dict):
            found.update(from_node(_flatten(section["ros__parameters"])))
    if not found and "plant" not in document:
        raise ParameterError(f"{path}: no parameters for eha_sim; expected `eha_sim: {{ros__parameters: {{...}}}}`")
    if PER_RECORDING in document:
        found.setdefault(PER_RECORDING, document[PER_RECORDING])
    if isinstance(document.get("plant"), dict):
        found |= _flatten(document["plant"], PART)
    return {name: _number(value) for name, value in found.items() if name.split(".")[0] not in NODE_ONLY}


def load_parameters(path: str | Path) -> dict[str, float]:
    """Read the plant's parameters from a file in ROS 2's YAML form.

    Returns only the names that the file gives; see `read_section`. Raises ParameterError naming the file when it cannot
    be read, a value is unknown or does not fit, or it names other parts than the paper's actuator has, which
    `eha_core.plant.plant_file` reads.
    """
    plant, parts = split_parts(read_section(path))
    plant.pop(PER_RECORDING, None)
    for kind, name in parts.items():
        if PAPER_PARTS.get(kind) != name:
            expected = ", ".join(f"{kind}: {name}" for kind, name in PAPER_PARTS.items())
            raise ParameterError(f"{path}: plant.{kind} = {name} is not taken here; give {expected}, or leave it out")
    refuse_unknown(path, plant)
    try:
        complete = changed(nominal_values(), plant)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error
    return {name: complete[name] for name in plant}


def refuse_unknown(path: str | Path, values: Mapping[str, object]) -> None:
    """Raise ParameterError, naming the file, where a value is `unknown`."""
    unknown = next((name for name, value in values.items() if is_unknown(value)), None)
    if unknown is not None:
        raise ParameterError(
            f"{path}: {unknown} is {UNKNOWN}, which only a diagnosis takes; give its value in {_unit_of(unknown)}"
        )


def split_parts(section: Mapping[str, object]) -> tuple[dict[str, object], dict[str, object]]:
    """The parameters that `read_section` found, and the parts that the file names under `plant:`, by kind."""
    parts = {name.removeprefix(PART): value for name, value in section.items() if name.startswith(PART)}
    return {name: value for name, value in section.items() if not name.startswith(PART)}, parts


def _unit_of(name: str) -> str:
    row = catalogue().get(name)
    return row.unit if row else "SI units"


def _flatten(section: Mapping[str, object], prefix: str = "") -> dict[str, object]:
    flat: dict[str, object] = {}
    for key, value in section.items():
        if isinstance(value, dict):
            flat.update(_flatten(value, f"{prefix}{key}."))
        else:
            flat[f"{prefix}{key}"] = value
    return flat


def _number(value: object) -> object:
    """YAML 1.1 reads 1e-12 (no point) as text; ROS reads it as a number, and so do we."""
    if isinstance(value, str):
        try:
            return float(value)
        except ValueError:
            return value
    return value


def dump_parameters(values: Mapping[str, float], heading: str = "") -> str:
    """The given parameters as the text of a ROS 2 parameters file for the simulator in any namespace, `heading` as its
    comment."""
    lines = [f"# {line}" for line in heading.splitlines()]
    lines += ["/**/eha_sim:", "  ros__parameters:"]
    for name, value in to_node(values).items():
        text = f"[{', '.join(map(number_text, value))}]" if isinstance(value, list) else number_text(value)
        lines.append(f"    {name}: {text}")
    return "\n".join(lines) + "\n"


def number_text(value: float) -> str:
    """A number with its point: without it, YAML 1.1 takes 1e-10 for text."""
    text = repr(float(value))
    mantissa, _, exponent = text.partition("e")
    return f"{mantissa}.0e{exponent}" if exponent and "." not in mantissa else text
