"""The .msg and .srv language: text in, frozen definitions out."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import Any

INTEGERS = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")
PRIMITIVES = ("bool", "byte", "char", "float32", "float64", *INTEGERS)
STRINGS = ("string", "wstring")
PLACEHOLDER = "structure_needs_at_least_one_member"

_TYPE = re.compile(r"^(?P<base>[\w/]+)(?:<=(?P<string>\d+))?(?:\[(?P<bound><=)?(?P<size>\d*)\])?$")
_FIELD_NAME = re.compile(r"^[a-z]([a-z0-9_]*[a-z0-9])?$", re.IGNORECASE)
_CONSTANT_NAME = re.compile(r"^[A-Za-z]([A-Za-z0-9_]*[A-Za-z0-9])?$")


class DefinitionError(ValueError):
    """A .msg or .srv text that cannot be understood; the message names the type, the line and what is wrong."""


@dataclass(frozen=True)
class FieldType:
    """The type of one field.

    base: a primitive, `string`, `wstring`, or a message name such as `std_msgs/msg/Header`.
    container: "" for one value, "array" for a fixed number, "sequence" for a variable one.
    size: length of an array, bound of a sequence (0: none). string_bound: most characters (0: none).
    """

    base: str
    container: str = ""
    size: int = 0
    string_bound: int = 0

    @property
    def is_message(self) -> bool:
        """Tell whether the element is itself a message."""
        return "/" in self.base


@dataclass(frozen=True)
class Field:
    """One field: its name, type and default as a Python value (None: the type's own zero)."""

    name: str
    type: FieldType
    default: Any = None


@dataclass(frozen=True)
class Constant:
    """One constant: its name, primitive type and value."""

    name: str
    base: str
    value: Any


@dataclass(frozen=True)
class Definition:
    """One message: `package/msg/Name` (or srv), its fields and constants, and its text when it came from a file."""

    name: str
    fields: tuple[Field, ...]
    constants: tuple[Constant, ...] = ()
    text: str = ""


def parse_message(name: str, text: str) -> Definition:
    """Parse the text of one message.

    Args:
        name: full name, `package/msg/Name`.
        text: the .msg file's content.

    Raises:
        DefinitionError: a line is not a field or a constant.
    """
    fields: list[Field] = []
    constants: list[Constant] = []
    for number, raw in enumerate(text.splitlines(), 1):
        line = _strip_comment(raw).strip()
        if not line:
            continue
        try:
            entry = _parse_line(name.split("/")[0], line)
        except (ValueError, SyntaxError) as error:
            raise DefinitionError(f"{name}, line {number}: {raw.strip()!r}: {error}") from error
        if isinstance(entry, Constant):
            constants.append(entry)
        elif any(entry.name == field.name for field in fields):
            raise DefinitionError(f"{name}, line {number}: field {entry.name!r} appears twice")
        else:
            fields.append(entry)
    return Definition(name, tuple(fields), tuple(constants), text)


def parse_service(name: str, text: str) -> tuple[Definition, Definition]:
    """Parse the text of one service into request and response.

    Raises:
        DefinitionError: the separator `---` is missing or doubled, or a line is not understood.
    """
    parts = re.split(r"^---[ \t]*$", text, flags=re.MULTILINE)
    if len(parts) != 2:
        raise DefinitionError(f"{name}: a service has exactly one '---' line, found {len(parts) - 1}")
    return parse_message(f"{name}_Request", parts[0]), parse_message(f"{name}_Response", parts[1])


def _strip_comment(line: str) -> str:
    quote = ""
    for index, character in enumerate(line):
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
        elif character == "#":
            return line[:index]
    return line


def _parse_line(package: str, line: str) -> Field | Constant:
    head, _, rest = line.partition(" ")
    rest = rest.strip()
    field_type = _parse_type(package, head)
    constant = re.match(r"^(\w+)\s*=\s*(.+)$", rest)
    if constant and not field_type.container and not field_type.is_message:
        if not _CONSTANT_NAME.match(constant[1]):
            raise ValueError(f"{constant[1]!r} is no constant name")
        return Constant(constant[1], field_type.base, _value(field_type, constant[2]))
    name, _, default = rest.partition(" ")
    if not _FIELD_NAME.match(name):
        raise ValueError(f"{name!r} is no field name")
    default = default.strip()
    if default and field_type.is_message:
        raise ValueError("a message field takes no default")
    return Field(name, field_type, _value(field_type, default) if default else None)


def _parse_type(package: str, text: str) -> FieldType:
    match = _TYPE.match(text)
    if not match:
        raise ValueError(f"{text!r} is no type")
    base = match["base"]
    if base not in PRIMITIVES and base not in STRINGS:
        parts = base.split("/")
        if len(parts) == 1:
            base = "std_msgs/msg/Header" if base == "Header" else f"{package}/msg/{base}"
        elif len(parts) == 2:
            base = f"{parts[0]}/msg/{parts[1]}"
        if not parts[-1][:1].isupper():
            raise ValueError(f"{text!r} is no type")
    if match["size"] is None:
        return FieldType(base, "", 0, int(match["string"] or 0))
    container = "array" if match["size"] and not match["bound"] else "sequence"
    return FieldType(base, container, int(match["size"] or 0), int(match["string"] or 0))


def _value(field_type: FieldType, text: str) -> Any:
    if not field_type.container:
        return _scalar(field_type.base, text)
    if not (text.startswith("[") and text.endswith("]")):
        raise ValueError(f"{text!r} is no list")
    values = ast.literal_eval(re.sub(r"\btrue\b", "True", re.sub(r"\bfalse\b", "False", text)))
    return [_scalar(field_type.base, value if isinstance(value, str) else str(value)) for value in values]


def _scalar(base: str, text: str) -> Any:
    if base in STRINGS:
        quoted = len(text) > 1 and text[0] == text[-1] and text[0] in "'\""
        return text[1:-1].replace(f"\\{text[0]}", text[0]) if quoted else text
    if base == "bool":
        return {"true": True, "1": True, "false": False, "0": False}[text.lower()]
    if base in ("float32", "float64"):
        return float(text)
    number = int(text, 0)
    return bytes([number]) if base == "byte" else number
