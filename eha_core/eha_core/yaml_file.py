"""Reads a YAML file of a user's; what is wrong with it is the caller's kind of error, in one line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from eha_core.bounded_yaml import YamlError, load_file
from eha_core.errors import EhaError


def load_yaml(path: str | Path, error: type[EhaError], where: str) -> Any:
    """The content of a YAML file.

    Args:
        path: the file.
        error: what is raised where it cannot be read or is no YAML.
        where: how messages begin: what the file is, and its name.
    """
    try:
        return load_file(path)
    except OSError as problem:
        raise error(f"{where}: cannot be read ({problem.strerror})") from problem
    except YamlError as problem:
        raise error(f"{where}: {problem}") from problem
