"""What stands behind --ros-args: remappings, parameters, log levels."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from rclpy_dds import bounded_yaml


class UnknownRosArguments(ValueError):
    """Arguments between --ros-args and -- that ROS does not know."""


@dataclass(frozen=True)
class Remap:
    """One rule `node:from:=to`; an empty node means every node."""

    node: str
    source: str
    target: str


@dataclass(frozen=True)
class ParameterRule:
    """One parameter value for the nodes a pattern such as `/**` or `/ns/node` matches."""

    pattern: str
    name: str
    value: Any


@dataclass
class Arguments:
    """Parsed arguments of a context or of one node, and what was not ROS's."""

    remaps: list[Remap] = field(default_factory=list)
    parameters: list[ParameterRule] = field(default_factory=list)
    log_levels: list[tuple[str, str]] = field(default_factory=list)
    enclave: str = "/"
    rosout: bool = True
    console: bool = True
    others: list[str] = field(default_factory=list)


_WITH_VALUE = {
    "-r": "remap", "--remap": "remap", "-p": "param", "--param": "param", "--params-file": "file",
    "--log-level": "level", "-e": "enclave", "--enclave": "enclave",
    "--log-config-file": "ignored", "--log-file-name": "ignored",
}  # fmt: skip
_SWITCHES = {
    "--enable-rosout-logs": ("rosout", True), "--disable-rosout-logs": ("rosout", False),
    "--enable-stdout-logs": ("console", True), "--disable-stdout-logs": ("console", False),
    "--enable-external-lib-logs": (None, True), "--disable-external-lib-logs": (None, False),
}  # fmt: skip
_LEVELS = ("UNSET", "DEBUG", "INFO", "WARN", "ERROR", "FATAL")


def parse(arguments: Sequence[str]) -> Arguments:
    """Parse a command line.

    Raises:
        UnknownRosArguments: something after --ros-args is not known.
        ValueError: a rule, value or file is malformed; the message says which.
    """
    parsed, unknown = Arguments(), []
    inside, rest = False, list(arguments)
    while rest:
        argument = rest.pop(0)
        if argument == "--ros-args":
            inside = True
        elif not inside:
            parsed.others.append(argument)
        elif argument == "--":
            inside = False
        elif argument in _SWITCHES:
            name, value = _SWITCHES[argument]
            if name:
                setattr(parsed, name, value)
        elif argument in _WITH_VALUE:
            if not rest or rest[0] == "--ros-args":
                raise ValueError(f"Couldn't parse trailing {argument} flag: it needs a value")
            _apply(parsed, _WITH_VALUE[argument], rest.pop(0))
        elif ":=" in argument and not argument.startswith("-"):
            parsed.remaps.append(_remap(argument))
        else:
            unknown.append(argument)
    if unknown:
        raise UnknownRosArguments(unknown)
    return parsed


def _apply(parsed: Arguments, kind: str, text: str) -> None:
    if kind == "remap":
        parsed.remaps.append(_remap(text))
    elif kind == "param":
        parsed.parameters.append(_parameter(text))
    elif kind == "file":
        parsed.parameters.extend(read_parameter_file(text))
    elif kind == "level":
        name, _, level = text.rpartition(":=")
        if level.upper() not in _LEVELS:
            raise ValueError(f"Couldn't parse log level {text!r}: use one of {', '.join(_LEVELS[1:]).lower()}")
        parsed.log_levels.append((name, level.upper()))
    elif kind == "enclave":
        parsed.enclave = text


def _remap(text: str) -> Remap:
    left, separator, target = text.partition(":=")
    node, _, source = left.rpartition(":")
    if not separator or not source or not target:
        raise ValueError(f"Couldn't parse remap rule '-r {text}': write from:=to or node:from:=to")
    for name in (source, target):
        if not re.match(r"^(rostopic:/?/?|rosservice:/?/?)?[~/A-Za-z_{][A-Za-z0-9_/{}~]*$", name):
            raise ValueError(f"Couldn't parse remap rule '-r {text}': {name!r} is no name")
    return Remap(node.lstrip("/"), source, target)


def _parameter(text: str) -> ParameterRule:
    left, separator, value = text.partition(":=")
    node, _, name = left.rpartition(":")
    if not separator or not name:
        raise ValueError(f"Couldn't parse parameter override rule '-p {text}': write name:=value")
    try:
        loaded = bounded_yaml.load(value)
    except bounded_yaml.YamlError as error:
        raise ValueError(f"Couldn't parse parameter override rule '-p {text}': {error}") from error
    return ParameterRule(f"/**/{node}" if node else "/**", name, check_value(name, loaded))


def check_value(name: str, value: Any) -> Any:
    """Return a parameter's value from YAML.

    Raises:
        ValueError: ROS 2 has no such type of parameter.
    """
    if isinstance(value, list):
        if any(isinstance(item, float) for item in value) and all(type(item) in (int, float) for item in value):
            return [float(item) for item in value]
        if any(isinstance(item, (list, dict)) for item in value) or len({type(item) for item in value}) > 1:
            raise ValueError(f"parameter {name}: a list holds values of one type, not {value!r}")
        return value
    if value is None:
        return None
    if isinstance(value, (bool, int, float, str)):
        return value
    return str(value)


def read_parameter_file(path: str) -> list[ParameterRule]:
    """Read a parameters file in ROS 2's YAML form.

    Raises:
        ValueError: the file cannot be read or is none.
    """
    try:
        content = bounded_yaml.load_file(path)
    except (OSError, bounded_yaml.YamlError) as error:
        raise ValueError(f"Couldn't parse params file {path!r}: {error}") from error
    if not isinstance(content, dict):
        raise ValueError(f"Couldn't parse params file {path!r}: it must map node names to ros__parameters")
    rules: list[ParameterRule] = []
    _collect(path, "", content, rules)
    return rules


def _collect(path: str, pattern: str, content: dict[str, Any], rules: list[ParameterRule]) -> None:
    for key, value in content.items():
        if key == "ros__parameters":
            if not isinstance(value, dict):
                raise ValueError(f"Couldn't parse params file {path!r}: ros__parameters of {pattern!r} is no mapping")
            rules.extend(ParameterRule(pattern, name, item) for name, item in flatten(value).items())
        elif isinstance(value, dict):
            _collect(path, f"{pattern}/{str(key).strip('/')}", value, rules)
        else:
            raise ValueError(f"Couldn't parse params file {path!r}: {key!r} stands outside ros__parameters")


def flatten(values: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return nested parameters under dotted names."""
    flat: dict[str, Any] = {}
    for key, value in values.items():
        if isinstance(value, dict):
            flat.update(flatten(value, f"{prefix}{key}."))
        else:
            flat[f"{prefix}{key}"] = check_value(f"{prefix}{key}", value)
    return flat


def matches(pattern: str, full_name: str) -> bool:
    """Tell whether a parameters file's pattern names the node: `*` is one token, `**` any number."""
    expression = re.escape(pattern).replace(r"/\*\*", "(?:/[^/]+)*").replace(r"\*", "[^/]+")
    return re.fullmatch(expression, full_name) is not None
