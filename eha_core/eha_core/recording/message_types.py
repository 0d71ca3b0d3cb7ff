"""Message types: their definitions, and the serialisation of fields to CDR.

No definition is repeated here: the standard messages come from the type store of the rosbags library, all others from
the .msg files that their package installs under `<prefix>/share/<package>/msg`.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from eha_core.errors import RecordingError

_SOURCE_TREE = Path(__file__).resolve().parents[3]
_IDL_DEFINITION = "ros2idl"
_TEXT_TYPES = ("string", "wstring")


def _message_folders(package: str) -> Iterator[Path]:
    """The folders that may contain a package's .msg files: ROS prefixes, this environment, the source tree, and the
    importable package."""
    prefixes = [prefix for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    for prefix in (*prefixes, sys.prefix):
        yield Path(prefix) / "share" / package / "msg"
    yield _SOURCE_TREE / package / "msg"
    spec = find_spec(package) if package.isidentifier() else None  # a dotted name would import what is before the dot
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        yield Path(folder) / "msg"


@lru_cache(maxsize=1)
def typestore() -> Typestore:
    """The store in which recordings are written: the standard messages, and what `require_type` added."""
    return get_typestore(Stores.ROS2_JAZZY)


def require_type(type_name: str) -> Typestore:
    """The store, with `type_name` ("package/msg/Name") and all types in it added.

    Raises:
        RecordingError: no definition of the type, or of one inside it, is installed.
    """
    store = typestore()
    if type_name in store.fielddefs:
        return store
    package, _, name = type_name.partition("/msg/")
    for folder in _message_folders(package):
        definition = folder / f"{name}.msg"
        if definition.is_file():
            break
    else:
        raise RecordingError(
            f"message type {type_name}: no definition found; install {package or 'its package'}"
            " or source the workspace that holds it"
        )
    try:
        types = get_types_from_msg(definition.read_text(encoding="utf-8"), type_name)
    except TypesysError as error:
        raise RecordingError(f"message type {type_name}: {definition} does not parse") from error
    for _, fields in types.values():
        for contained in _contained_types(fields):
            require_type(contained)
    store.register(types)
    return store


def _contained_types(fields: Any) -> Iterator[str]:
    for _, (kind, detail) in fields:
        if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            kind, detail = detail[0]
        if kind == Nodetype.NAME:
            yield detail


@lru_cache(maxsize=256)
def definition_of(type_name: str) -> tuple[str, str]:
    """The definition as `ros2 bag` stores it (parts divided by rows of 80 "=") and the type's hash (RIHS01)."""
    store = require_type(type_name)
    return store.generate_msgdef(type_name, ros_version=2)[0], store.hash_rihs01(type_name)


def encode(type_name: str, fields: Mapping[str, Any]) -> bytes:
    """Serialise a message, given as nested mappings and sequences, to CDR; omitted fields are zero or empty."""
    store = require_type(type_name)
    return bytes(store.serialize_cdr(_build(store, type_name, fields), type_name))


def _build(store: Typestore, type_name: str, values: Mapping[str, Any]) -> Any:
    fields = store.fielddefs[type_name][1]
    unknown = set(values) - {name for name, _ in fields}
    if unknown:
        raise RecordingError(f"message type {type_name}: has no field {', '.join(sorted(unknown))}")
    return store.types[type_name](**{name: _build_field(store, kind, values.get(name)) for name, kind in fields})


def _build_field(store: Typestore, description: Any, value: Any) -> Any:
    kind, detail = description
    if kind == Nodetype.NAME:
        return _build(store, detail, value or {})
    if kind == Nodetype.BASE:
        return value if value is not None else ("" if detail[0] in _TEXT_TYPES else 0)
    element, length = detail
    if element[0] == Nodetype.BASE and element[1][0] not in _TEXT_TYPES:
        numbers = value if value is not None else np.zeros(length if kind == Nodetype.ARRAY else 0)
        return np.asarray(numbers, dtype=element[1][0] if element[1][0] not in ("byte", "char") else np.uint8)
    return [_build_field(store, element, item) for item in (value or ())]


LARGEST_DEFINITION = 2**17
"""Most characters of a type with all types in it; the longest of ROS's own has 2**14."""
DEEPEST_TYPE = 20
"""Most levels of nested types; ROS's own have 6."""
MOST_ELEMENTS = 2**20
"""Most numbers and texts in fixed arrays of a message: a definition of 40 lines must not cost an hour of decoding."""


@lru_cache(maxsize=64)
def _recorded_types(type_name: str, encoding: str, definition: str) -> Typestore | None:
    """The store made from a recording's own definition of a type; None where that is damaged or too large."""
    store = get_typestore(Stores.EMPTY)
    if len(definition) > LARGEST_DEFINITION:
        return None
    try:
        is_idl = encoding == _IDL_DEFINITION
        types = get_types_from_idl(definition) if is_idl else get_types_from_msg(definition, type_name)
        if _elements(types, type_name, DEEPEST_TYPE) > MOST_ELEMENTS:
            return None
        store.register(types)
        store.get_msgdef(type_name)  # fails here, not at the first message, where a part is missing
    except (TypesysError, SyntaxError, ValueError, LookupError, RecursionError, TypeError, AttributeError):
        return None
    return store


def _elements(types: Any, type_name: str, levels: int) -> int:
    """The number of elements in a type's fixed arrays, with its parts'. Raises ValueError if it is nested too deep."""
    if levels == 0:
        raise ValueError(f"{type_name} contains types too deep")
    total = 1
    for _, (kind, detail) in types[type_name][1]:
        element, count = detail if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE) else ((kind, detail), 1)
        inner = _elements(types, element[1], levels - 1) if element[0] == Nodetype.NAME else 1
        total += inner * (count if kind == Nodetype.ARRAY else 1)
        if total > MOST_ELEMENTS:
            break
    return total


def recorded_types(type_name: str, encoding: str, definition: str) -> tuple[Typestore, str | None]:
    """The types for reading a recording's messages, and a remark where they are not its own.

    A recording without definitions (the SQLite bags of older distributions), or with a damaged one, is read by the
    installed ones.

    Raises:
        RecordingError: the type is neither defined in the recording nor installed.
    """
    store = _recorded_types(type_name, encoding, definition) if definition.strip() else None
    if store is not None:
        return store, None
    remark = f"the definition of {type_name} in the file cannot be used; the installed one was taken"
    return require_type(type_name), remark if definition.strip() else None
