"""From a YAML launch file to a list of processes."""

from __future__ import annotations

import os
import re
import uuid
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import yaml
from ament_index_python.packages import get_package_prefix, get_package_share_directory

from rclpy_dds import bounded_yaml
from rclpy_dds.errors import CommandError
from rclpy_dds.executables import find_executable

_KNOWN = (
    "arg",
    "let",
    "node",
    "executable",
    "include",
    "group",
    "set_env",
    "unset_env",
    "push_ros_namespace",
    "push-ros-namespace",
)


class LaunchError(ValueError):
    """A launch file that cannot be carried out; the message names the file, what is wrong and what would do."""


@dataclass(frozen=True, eq=False)
class Process:
    """One process to start: its label in the output, command, environment and what happens when it ends."""

    label: str
    command: list[str]
    environment: dict[str, str]
    respawn: bool = False
    respawn_delay: float = 0.0
    shutdown_on_exit: bool = False


@dataclass
class _Scope:
    """What a launch file's entries see: configurations, environment, namespace, and the file's own folder."""

    path: str
    given: dict[str, str]
    values: dict[str, str] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=dict)
    namespace: str = ""
    processes: list[Process] = field(default_factory=list)

    def inner(self) -> _Scope:
        """Return a scope whose changes end with it; processes go to the same list."""
        return _Scope(self.path, self.given, dict(self.values), dict(self.environment), self.namespace, self.processes)


def read(path: str, arguments: Mapping[str, str]) -> list[Process]:
    """Return the processes a launch file describes.

    Raises:
        LaunchError: the file cannot be read or understood.
    """
    scope = _Scope(path, dict(arguments), dict(arguments))
    _carry_out(_load(path), scope)
    return scope.processes


def declared_arguments(path: str) -> list[tuple[str, str | None, str]]:
    """Return (name, default, description) of the arguments a launch file declares."""
    entries = (entry["arg"] for entry in _load(path) if isinstance(entry, dict) and "arg" in entry)
    return [
        (e["name"], None if "default" not in e else str(e["default"]), str(e.get("description", ""))) for e in entries
    ]


def _load(path: str) -> list[Any]:
    try:
        content = bounded_yaml.load_file(path)
    except (OSError, bounded_yaml.YamlError) as error:
        raise LaunchError(f"{path}: cannot read the launch file: {error}") from None
    if not isinstance(content, dict) or not isinstance(content.get("launch"), list):
        raise LaunchError(f"{path}: a launch file holds a list under 'launch:'")
    return content["launch"]


def _carry_out(entries: list[Any], scope: _Scope) -> None:
    for entry in entries:
        if not isinstance(entry, dict) or len(entry) != 1:
            raise LaunchError(f"{scope.path}: an entry is one action and its attributes, not {entry!r}")
        [(action, attributes)] = entry.items()
        if action not in _KNOWN:
            raise LaunchError(
                f"{scope.path}: action {action!r} is not offered by rclpy_dds; it knows {', '.join(_KNOWN)}"
            )
        if isinstance(attributes, dict) and not _wanted(attributes, scope):
            continue
        try:
            _ACTIONS[action.replace("-", "_")](attributes, scope)
        except KeyError as error:
            raise LaunchError(f"{scope.path}: action {action!r} lacks the attribute {error}") from None
        except CommandError as error:
            raise LaunchError(f"{scope.path}: {error}") from None


def _wanted(attributes: dict[str, Any], scope: _Scope) -> bool:
    if "if" in attributes:
        return _is_true(_text(attributes["if"], scope), scope)
    return not ("unless" in attributes and _is_true(_text(attributes["unless"], scope), scope))


def _is_true(text: str, scope: _Scope) -> bool:
    if text.strip().lower() in ("true", "1"):
        return True
    if text.strip().lower() in ("false", "0"):
        return False
    raise LaunchError(f"{scope.path}: a condition is true, false, 1 or 0, not {text!r}")


def _declare(attributes: dict[str, Any], scope: _Scope) -> None:
    name = attributes["name"]
    if name in scope.given:
        scope.values[name] = scope.given[name]
    elif "default" in attributes:
        scope.values[name] = _text(attributes["default"], scope)
    elif name not in scope.values:
        raise LaunchError(f"{scope.path}: required launch argument '{name}' was not provided; pass {name}:=VALUE")
    choices = [str(choice["value"] if isinstance(choice, dict) else choice) for choice in attributes.get("choice", ())]
    if choices and scope.values[name] not in choices:
        raise LaunchError(f"{scope.path}: argument {name} is {scope.values[name]!r}, not one of {', '.join(choices)}")


def _let(attributes: dict[str, Any], scope: _Scope) -> None:
    scope.values[attributes["name"]] = _text(attributes["value"], scope)


def _set_environment(attributes: dict[str, Any], scope: _Scope) -> None:
    scope.environment[attributes["name"]] = _text(attributes["value"], scope)


def _unset_environment(attributes: dict[str, Any], scope: _Scope) -> None:
    scope.environment[attributes["name"]] = ""


def _push_namespace(attributes: dict[str, Any] | str, scope: _Scope) -> None:
    text = _text(attributes["namespace"] if isinstance(attributes, dict) else attributes, scope)
    scope.namespace = _joined(scope.namespace, text)


def _joined(namespace: str, name: str) -> str:
    if not name:
        return namespace
    return name if name.startswith("/") else f"{namespace.rstrip('/')}/{name}"


def _group(attributes: Any, scope: _Scope) -> None:
    children = attributes
    scoped = True
    if isinstance(attributes, dict):
        children = next((attributes[key] for key in ("actions", "children") if key in attributes), [])
        scoped = str(attributes.get("scoped", True)).lower() != "false"
    if not isinstance(children, list):
        raise LaunchError(f"{scope.path}: a group holds a list of actions")
    _carry_out(children, scope.inner() if scoped else scope)


def _include(attributes: dict[str, Any], scope: _Scope) -> None:
    path = _text(attributes["file"], scope)
    if not path.endswith((".yaml", ".yml")):
        raise LaunchError(
            f"{scope.path}: cannot include {path}: rclpy_dds launches YAML files only; install ROS 2 for others"
        )
    given = dict(scope.values)
    given.update({entry["name"]: _text(entry["value"], scope) for entry in attributes.get("arg", ())})
    inner = scope.inner()
    inner.path, inner.given, inner.values = path, given, given
    _carry_out(_load(path), inner)


def _node(attributes: dict[str, Any], scope: _Scope) -> None:
    package, name = _text(attributes["pkg"], scope), _text(attributes["exec"], scope)
    command = [find_executable(package, name), *_text(attributes.get("args", ""), scope).split()]
    ros: list[str] = _text(attributes.get("ros_args", ""), scope).split()
    if "name" in attributes:
        ros += ["-r", f"__node:={_text(attributes['name'], scope)}"]
    namespace = _joined(scope.namespace, _text(attributes.get("namespace", ""), scope))
    if namespace:
        ros += ["-r", f"__ns:={namespace}"]
    for entry in attributes.get("param", ()):
        ros += _parameter(entry, scope, "")
    for entry in attributes.get("remap", ()):
        ros += ["-r", f"{_text(entry['from'], scope)}:={_text(entry['to'], scope)}"]
    if ros:
        command += ["--ros-args", *ros]
    _add(name, command, attributes, scope)


def _parameter(entry: dict[str, Any], scope: _Scope, prefix: str) -> list[str]:
    if "from" in entry:
        return ["--params-file", _text(entry["from"], scope)]
    name = f"{prefix}{_text(entry['name'], scope)}"
    if "param" in entry:
        return [text for inner in entry["param"] for text in _parameter(inner, scope, f"{name}.")]
    value = entry["value"]
    if isinstance(value, str):
        text = _text(value, scope)
    else:
        text = yaml.safe_dump(_substituted(value, scope), default_flow_style=True).strip().removesuffix("\n...").strip()
    return ["-p", f"{name}:={text}"]


def _substituted(value: Any, scope: _Scope) -> Any:
    if isinstance(value, list):
        return [_substituted(item, scope) for item in value]
    return bounded_yaml.load(_text(value, scope)) if isinstance(value, str) and "$(" in value else value


def _executable(attributes: dict[str, Any], scope: _Scope) -> None:
    command = _text(attributes["cmd"], scope).split()
    _add(_text(attributes.get("name", os.path.basename(command[0])), scope), command, attributes, scope)


def _add(name: str, command: list[str], attributes: dict[str, Any], scope: _Scope) -> None:
    environment = dict(scope.environment)
    environment.update({entry["name"]: _text(entry["value"], scope) for entry in attributes.get("env", ())})
    scope.processes.append(
        Process(
            f"{name}-{len(scope.processes) + 1}",
            command,
            environment,
            respawn=_is_true(_text(attributes.get("respawn", "false"), scope), scope),
            respawn_delay=float(_text(attributes.get("respawn_delay", "0"), scope)),
            shutdown_on_exit=_text(attributes.get("on_exit", ""), scope) == "shutdown",
        )
    )


_ACTIONS = {
    "arg": _declare, "let": _let, "node": _node, "executable": _executable, "include": _include, "group": _group,
    "set_env": _set_environment, "unset_env": _unset_environment, "push_ros_namespace": _push_namespace,
}  # fmt: skip


def _text(value: Any, scope: _Scope) -> str:
    """Return an attribute as text with its $(substitutions) carried out, the innermost first."""
    if isinstance(value, bool):
        return "true" if value else "false"
    text = str(value)
    while match := re.search(r"\$\(([^()$]*)\)", text):
        text = text[: match.start()] + _substitution(match[1].strip(), scope) + text[match.end() :]
    return text


def _substitution(text: str, scope: _Scope) -> str:
    kind, _, rest = text.partition(" ")
    words = [word.strip("'\"") for word in rest.split()]
    if kind == "dirname":
        return os.path.dirname(os.path.abspath(scope.path))
    if kind == "filename":
        return os.path.basename(scope.path)
    if not words:
        raise LaunchError(f"{scope.path}: substitution $({text}) lacks its argument")
    if kind == "var":
        if words[0] not in scope.values and len(words) < 2:
            raise LaunchError(f"{scope.path}: launch configuration '{words[0]}' does not exist")
        return scope.values.get(words[0], " ".join(words[1:]))
    if kind in ("env", "optenv"):
        if words[0] not in os.environ and len(words) < 2 and kind == "env":
            raise LaunchError(f"{scope.path}: environment variable '{words[0]}' does not exist")
        return os.environ.get(words[0], " ".join(words[1:]))
    if kind in ("find-pkg-share", "find-pkg-prefix"):
        find = get_package_share_directory if kind == "find-pkg-share" else get_package_prefix
        try:
            return find(words[0])
        except LookupError as error:
            raise LaunchError(f"{scope.path}: {error}") from None
    if kind == "exec-in-pkg" and len(words) > 1:
        return find_executable(words[1], words[0])
    if kind == "anon":
        return f"{words[0]}_{os.getpid()}_{uuid.uuid4().hex[:8]}"
    if kind == "not":
        return "false" if _is_true(words[0], scope) else "true"
    raise LaunchError(f"{scope.path}: substitution $({text}) is not offered by rclpy_dds")
