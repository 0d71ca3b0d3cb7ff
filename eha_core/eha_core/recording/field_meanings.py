"""The meaning of a field, from its name and its unit."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from eha_core.recording.column_names import Meaning, meaning_of, without_reference
from eha_core.recording.inspection import Field, Inspection
from eha_core.unit_names import unit_named

LOOP = (3.5e-3, 20.5e-3)
"""A; range of a current loop, whose ends are 4 and 20 mA."""


@dataclass(frozen=True)
class MeantField:
    """A field, and the meaning of its name."""

    field: Field
    meaning: Meaning


def meant(field: Field, common: frozenset[str] = frozenset()) -> MeantField:
    """The meaning of a field's name without its unit; `common` are words that most names of its file begin with."""
    if "command_interface" in field.path:
        return MeantField(field, Meaning(frozenset({"voltage_command"}), "command", True, True))
    meaning = meaning_of(plain_name(field), field.unit, common)
    unit = unit_named(field.unit)
    is_loop = (
        unit is not None and unit.si == "A" and LOOP[0] <= field.low * unit.scale <= field.high * unit.scale <= LOOP[1]
    )
    if is_loop and meaning.channels == {"current"} and meaning.quantity != "current":
        # A valve's current between 4 and 20 mA is a command; a coil's current has both signs, or is named so.
        meaning = replace(meaning, channels=frozenset({"voltage_command"}))
    return MeantField(field, meaning)


def plain_name(field: Field) -> str:
    """A field's name without its unit; a message's only number has its topic's name."""
    # `data` means nothing.
    path = re.sub(r"(^|[./])(data|fluid_pressure|value|values)(\[\d+\])?$", "", field.path)
    name = path if path and not field.path.startswith("data") else f"{field.topic}/{path}"
    if field.topic:
        return name
    # The labels of a historian's series and a drive's parameter numbers are not names.
    name = re.sub(r"\{[^{}]*=[^{}]*\}|\b[SP]-\d-\d{4}\b", " ", name).strip() or name
    if re.fullmatch(r"[A-Za-z]{1,2}\d?\[\d+\]", name):
        return ""  # a row of a matrix: the matrix' symbol does not name its rows
    if field.unit:
        name = without_reference(name)
        unit = re.escape(field.unit)
        bare = re.sub(rf"\s*[\[(<{{]\s*{unit}\s*[\])>}}]", " ", name).strip()
        name = bare if bare != name else re.sub(rf"(?:[\s_/,:;|-]+|(?<=[a-z])(?=[A-Z]))(?i:{unit})$", "", name)
    name = re.sub(r"\s*[\[(][^\[\]()]*[\])]\s*$", "", name)
    return re.sub(r"[\s_]+in\s*$", "", re.sub(r"\s+-\s+[A-Za-z]+\s*\d+\s*$", "", name))


def is_doubled(field: Field, inspection: Inspection) -> bool:
    """Whether a field of ros2_control's introspection is in the file a second time, in the smaller messages."""
    start, _, last = field.topic.rpartition("/")
    return (
        last == "full"
        and inspection.topics.get(f"{start}/values", "").endswith("/StatisticsValues")
        and any(copy.topic == f"{start}/values" and not re.search(r"\[\d+\]", copy.path) for copy in inspection.fields)
    )
