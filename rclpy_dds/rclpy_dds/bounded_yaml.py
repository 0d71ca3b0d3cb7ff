"""Reads YAML of strangers: within ceilings of size and depth, without aliases, no key twice, numbers as ROS 2 has them.

It knows nothing of this library. `rclpy_dds`, which may not import this package, holds a link to the file: a parameters
file means the same to a node and to `eha`.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

LARGEST = 2**20
"""Bytes of a file; one of parameters, topics, nodes to launch or a bag's description is a hundredth of it."""
DEEPEST = 20
"""Levels of nesting; ROS's parameter files have 4."""
_LONG_NUMBER = re.compile(r"[-+]?[\d_:]{30,}")
_INTEGER = re.compile(r"[-+]?(?:0b[01_]+|0x[\da-fA-F_]+|0[0-7_]*|[1-9][\d_]*)$")
_REAL = re.compile(
    r"[-+]?(?:(?:\d[\d_]*\.[\d_]*|\.\d[\d_]*)(?:[eE][-+]?\d+)?|\d+[eE][-+]?\d+|\.(?:inf|Inf|INF))$|\.(?:nan|NaN|NAN)$"
)
_MERGE, _INT, _FLOAT = (f"tag:yaml.org,2002:{name}" for name in ("merge", "int", "float"))


class YamlError(ValueError):
    """What is read is no YAML, or passes a ceiling: one line that says what, and in which line."""


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """The safe loader, by libyaml where PyYAML has it, which is ten times as fast; no key twice in a mapping."""

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:
        lines: dict[str, int] = {}
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode) and key.tag != _MERGE:
                if key.value in lines:
                    raise _refused(f"{key.value} is already in line {lines[key.value]}; keep one of them", key)
                lines[key.value] = key.start_mark.line + 1
        return super().construct_mapping(node, deep)

    def construct_scalar(self, node: Any) -> Any:
        value = super().construct_scalar(node)
        if isinstance(value, str) and not node.style and _LONG_NUMBER.fullmatch(value):
            raise _refused("a number of more than 30 digits", node)
        return value


# YAML 1.1 has 1:30:00 for 5400 and takes 1e-10 for text; ROS 2's own reader has neither.
_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in rules if tag not in (_INT, _FLOAT)]
    for first, rules in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver(_FLOAT, _REAL, list("-+0123456789."))
_Loader.add_implicit_resolver(_INT, _INTEGER, list("-+0123456789"))


def load(text: str) -> Any:
    """The content of a YAML text. Raises YamlError."""
    try:
        _check(text)
        return yaml.load(text, _Loader)
    except yaml.YAMLError as problem:
        mark = getattr(problem, "problem_mark", None)
        # Of what is missing at the end libyaml says the line after it.
        line = f"line {min(mark.line, text.count(chr(10))) + 1}: " if mark else ""
        what = " ".join(str(getattr(problem, "problem", None) or problem).split())
        raise YamlError(f"this is not YAML ({line}{what})") from problem
    except YamlError:
        raise
    except (ValueError, OverflowError, TypeError, RecursionError, AttributeError) as problem:
        raise YamlError(f"holds a value that is none ({problem})") from problem


def _check(text: str) -> None:
    """Refuse what could grow beyond the text: aliases, as ROS 2's own reader does, and deep nesting."""
    depth = 0
    for event in yaml.parse(text, _Loader):
        if isinstance(event, yaml.AliasEvent):
            raise _refused("aliases are not read; write the value out", event)
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > DEEPEST:
            raise _refused(f"nested more than {DEEPEST} levels deep", event)


def load_file(path: str | Path) -> Any:
    """The content of a YAML file. Raises OSError and YamlError."""
    with Path(path).open("rb") as file:
        data = file.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise YamlError(f"is larger than {LARGEST / 1e6:.0f} MB; this is not the file that is meant")
    try:
        return load(data.decode("utf-8"))
    except UnicodeDecodeError as problem:
        raise YamlError("this is not YAML, nor any text") from problem


def _refused(what: str, place: Any) -> YamlError:
    return YamlError(f"line {place.start_mark.line + 1}: {what}")
