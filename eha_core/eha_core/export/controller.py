"""A controller for the actuator: gains for ros2_control, and the inverse model as C and as Python that need nothing."""

from __future__ import annotations

import inspect
import re
from importlib import resources
from pathlib import Path

from eha_core.control import inverse_model
from eha_core.errors import EhaError
from eha_core.export.model import ExportedModel
from eha_core.export.ros2_control import controllers_text
from eha_core.parameters import catalogue

GAINS, HEADER, SOURCE, PYTHON = "controllers.yaml", "eha_controller.h", "eha_controller.c", "eha_controller.py"

_LIMITS = ("REVERSAL", "OVERLAP_ROUNDING", "LEAST_DROP", "LEAST_SHARE")  # of `inverse_model`


def compensation(model: ExportedModel) -> tuple[list[str], list[str]]:
    """The effects that act: those that the exported law compensates, and those that it does not."""
    known = {name.partition(".")[0] for name in inverse_model.NAMES}
    return [each for each in model.acting if each in known], [each for each in model.acting if each not in known]


def write_controller(model: ExportedModel, folder: Path, rate: int, origin: str) -> tuple[Path, ...]:
    """Write the gains, and the law in C and in Python; return the files.

    Args:
        model: the actuator.
        folder: where to; it is made if it is missing.
        rate: the controller's rate [Hz].
        origin: what the values were read from, for the files' first lines.

    Raises ParameterError where no gains make a sound loop, EhaError where a file cannot be written.
    """
    values = {name: float(value) for name, value in model.composition.places(model.values).items()}
    compensated, left = (", ".join(names) or "none" for names in compensation(model))
    origin = re.sub(r"[^\w.+ -]", "_", origin)  # it stands in comments of three languages
    heading = [
        f"Written by `eha export controller` from {origin}.",
        f"Effects compensated: {compensated}. Effects that act and are not compensated: {left}.",
    ]
    header = (resources.files("eha_core.export") / "c" / HEADER).read_text(encoding="utf-8")
    files = {
        GAINS: controllers_text(values, rate, f"# {heading[0]}"),
        HEADER: header,
        SOURCE: _c_text(values, heading),
        PYTHON: _python_text(values, heading),
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise EhaError(f"{folder}: cannot be written ({error.strerror}); choose another --out") from error
    return tuple(folder / name for name in files)


def _c_text(values: dict[str, float], heading: list[str]) -> str:
    """`eha_controller.c`: the values as constants, and the law that uses them."""
    law = (resources.files("eha_core.export") / "c" / SOURCE).read_text(encoding="utf-8")
    lines = [f"/* {heading[0]}", f"   {heading[1]} */", f'#include "{HEADER}"', "", "#include <math.h>", ""]
    for name in inverse_model.NAMES:
        row = catalogue()[name]
        lines.append(f"{_constant(name)} = {values[name]!r}; /* [{row.unit}] {row.meaning} */")
    lines += [f"static const double {name} = {getattr(inverse_model, name)!r};" for name in _LIMITS]
    return "\n".join([*lines, "", law])


def _constant(name: str) -> str:
    """How a value is declared; the supply pressure, which may be measured instead, is the header's."""
    if name == "supply_pressure":
        return "const double eha_supply_pressure"
    return f"static const double {name.replace('.', '_').upper()}"


def _python_text(values: dict[str, float], heading: list[str]) -> str:
    """`eha_controller.py`: the text of `inverse_model` under a docstring of its own, and the values."""
    _, _, law = inspect.getsource(inverse_model).partition('\n"""\n\n')
    lines = [
        '"""The voltage that moves a diagnosed actuator along a motion. It needs nothing but `math`.', "", *heading, "",
        "    from eha_controller import ACTUATOR",
        "    volts = ACTUATOR.voltage(position, velocity, acceleration)  # m, m/s, m/s^2",
        '"""', "", law, "", "VALUES = {",
    ]  # fmt: skip
    for name in inverse_model.NAMES:
        row = catalogue()[name]
        lines.append(f'    "{name}": {values[name]!r},  # [{row.unit}] {row.meaning}')
    return "\n".join([*lines, "}", "", "ACTUATOR = InverseModel(VALUES)", ""])
