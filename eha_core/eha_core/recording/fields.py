"""Finds a number in a message by its path, such as `data`, `wrench.force.x`, `position[0]` or `position[piston]`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

from eha_core.errors import RecordingError
from eha_core.recording.cdr_layout import Layout, Run

_STEP = re.compile(r"([A-Za-z_]\w*)(?:\[([^\[\]]+)\])?(\.|$)")
PISTON = "piston"
_NAMED_BY_VERSION = "pal_statistics_msgs/msg/StatisticsValues"

Steps = tuple[tuple[str, str | None], ...]
Tables = Mapping[int, Sequence[str]]
"""Names of the values of a ros2_control introspection topic, by the version that its messages carry."""


def is_named_by_version(type_name: str) -> bool:
    """Whether the names of a message's values are on another topic, as in ros2_control's introspection."""
    return type_name == _NAMED_BY_VERSION


def parse_path(topic: str, path: str) -> Steps:
    """The fields of a path, each with its index if it has one.

    Raises:
        RecordingError: it is not a path.
    """
    steps: list[tuple[str, str | None]] = []
    position, ended = 0, False
    while not ended and (match := _STEP.match(path, position)):
        steps.append((match[1], match[2]))
        position, ended = match.end(), match[3] == ""
    if not ended:
        raise RecordingError(f"{topic}: field {path!r} is not a path such as data, wrench.force.x or position[0]")
    return tuple(steps)


def check_path(topic: str, path: str, steps: Steps, store: Typestore, type_name: str) -> None:
    """Raise RecordingError where messages of a type cannot have a number at a path."""
    kind: tuple[Any, Any] = (Nodetype.NAME, type_name)
    for name, index in steps:
        fields = dict(store.fielddefs[kind[1]][1]) if kind[0] == Nodetype.NAME else {}
        if name not in fields:
            names = ", ".join(dict(store.fielddefs[type_name][1]))
            raise RecordingError(f"{topic}: its message has no field {path!r}; its fields are {names}")
        kind = fields[name]
        if index is not None and kind[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            kind = kind[1][0]
        elif index is not None:
            raise RecordingError(f"{topic}: field {path!r} has an index where there is one value; leave it out")
    if kind[0] != Nodetype.BASE or kind[1][0] in ("string", "wstring"):
        raise RecordingError(f"{topic}: field {path!r} is not one number; name an element such as {path}[0]")


def uses_names(steps: Steps) -> bool:
    """Whether a path names an element by a text of the message."""
    return any(index is not None and not index.isdigit() for _, index in steps)


def find(topic: str, steps: Steps, layout: Layout, tables: Tables, version: int | None) -> Run | None:
    """The place of the number in messages of a layout; None where they lack the element.

    An index may be a number, the name of a part that has one, or, in a message with joint names, a joint:
    `position[piston]` is the joint of that name, or the only one.

    Raises:
        RecordingError: it is not clear which joint or part is meant.
    """
    path = ""
    for name, index in steps[:-1]:
        path += name
        if index is not None:
            element = _element(topic, path, index, layout, tables, version)
            path += f"[{element}]"
        path += "."
    name, index = steps[-1]
    run = layout.runs.get(path + name)
    if run is None or index is None:
        return run
    element = _element(topic, path + name, index, layout, tables, version)
    if run.count is None or element >= run.count:
        return None
    return Run(run.offset + element * run.size, run.kind, None)


def _element(topic: str, path: str, index: str, layout: Layout, tables: Tables, version: int | None) -> int:
    if index.isdigit():
        return int(index)
    names = _names(path, layout)
    if version is not None:
        if version not in tables:
            raise RecordingError(
                f"{topic}: the names of its values (version {version}) were not recorded; record {names_topic(topic)}"
                " from its start, or say the element's number, as in values[0]"
            )
        names = list(tables[version])
    if index in names:
        return names.index(index)
    if len(names) > 1 or version is not None:
        listed = ", ".join(names[:20]) + (" ..." if len(names) > 20 else "")
        what = "joints" if index == PISTON else "names"
        raise RecordingError(
            f"{topic}: holds the {what} {listed} and none is called {index};"
            " say which in a topics file, for example `position: {field: position[0]}`"
        )
    return 0


def _names(path: str, layout: Layout) -> list[str]:
    """The names of a sequence's elements: of parts their own `name`, of numbers the sequence `name`."""
    if path in layout.elements:
        return [layout.texts.get(f"{path}[{k}].name", "") for k in range(layout.elements[path])]
    siblings = f"{path.rpartition('.')[0]}.name".lstrip(".")
    return [layout.texts[f"{siblings}[{k}]"] for k in range(layout.elements.get(siblings, 0))]


def names_topic(topic: str) -> str:
    """The topic with the names of an introspection topic's values."""
    return f"{topic.rpartition('/')[0]}/names"
