"""Reads YAML files of strangers: within ceilings of size and depth, without aliases, any fault reported in one line."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

from eha_core.errors import EhaError

LARGEST = 2**20
"""Bytes; a file of parameters, topics or a bag's description is a hundredth of it."""
DEEPEST = 20
"""Levels of nesting; ROS's parameter files have 4."""
_LONG_NUMBER = re.compile(r"[-+]?[\d_:]{30,}")


class _Loader(yaml.SafeLoader):
    """The safe loader without aliases, which grow without bound (ROS 2's own reader refuses them, too)."""

    depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.AliasEvent):
            event = self.peek_event()
            raise yaml.MarkedYAMLError(problem="aliases are not read", problem_mark=event.start_mark)
        self.depth += 1
        if self.depth > DEEPEST:
            raise yaml.MarkedYAMLError(
                problem=f"nested more than {DEEPEST} levels deep", problem_mark=self.peek_event().start_mark
            )
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_scalar(self, node: Any) -> Any:
        value = super().construct_scalar(node)
        if isinstance(value, str) and node.style is None and _LONG_NUMBER.fullmatch(value):
            raise yaml.MarkedYAMLError(problem="a number of more than 30 digits", problem_mark=node.start_mark)
        return value


def load_yaml(path: str | Path, error: type[EhaError], where: str) -> Any:
    """The content of a YAML file.

    Args:
        path: the file.
        error: what is raised where it cannot be read or is no YAML.
        where: how messages begin: what the file is, and its name.
    """
    try:
        with Path(path).open("rb") as file:
            data = file.read(LARGEST + 1)
    except OSError as problem:
        raise error(f"{where}: cannot be read ({problem.strerror})") from problem
    if len(data) > LARGEST:
        raise error(f"{where}: is larger than {LARGEST / 1e6:.0f} MB; this is not the file that is meant")
    try:
        return yaml.load(data.decode("utf-8"), _Loader)
    except UnicodeDecodeError as problem:
        raise error(f"{where}: this is not YAML, nor any text") from problem
    except yaml.YAMLError as problem:
        mark = getattr(problem, "problem_mark", None)
        line = f"line {mark.line + 1}: " if mark else ""
        raise error(f"{where}: this is not YAML ({line}{getattr(problem, 'problem', None) or problem})") from problem
    except (ValueError, OverflowError, TypeError, RecursionError, AttributeError) as problem:
        raise error(f"{where}: holds a value that is none ({problem})") from problem
