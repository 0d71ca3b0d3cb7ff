"""Entry point of `ros2`: finds command and verb, runs it, turns errors into one line."""

from __future__ import annotations

import argparse
import importlib
import os
import pkgutil
import sys
from types import ModuleType
from typing import Any

from rclpy_dds import commands
from rclpy_dds.errors import CommandError

_ROS_2 = "install ROS 2 for it (https://docs.ros.org)"
_NOT_OFFERED = {
    "action": ("actions", _ROS_2), "lifecycle": ("lifecycle nodes", _ROS_2), "security": ("security", _ROS_2),
    "component": ("components", "start each node with `ros2 run`"),
    "daemon": ("a daemon", "a command finds the nodes by itself; `--spin-time` says for how long it looks"),
    "multicast": ("multicast tests", "`ros2 doctor` reports settings, topics and what does not match"),
    "wtf": ("wtf", "use `ros2 doctor`"),
}  # fmt: skip
"""Commands of ROS 2 that are missing, and what to do in their place."""
_INSTEAD = {
    "bag reindex": "bag info", "interface package": "interface list", "interface packages": "interface list",
    "interface proto": "interface show", "pkg list": "pkg executables", "service info": "service type",
}  # fmt: skip
"""Verbs of ROS 2 that are missing, and those that say the like."""
_HELPERS = ("main", "common", "values", "param_common")


def main(argv: list[str] | None = None) -> int:
    """Run `ros2 ARGV` and return its exit status."""
    from rclpy_dds.finder import real_rclpy_present

    if real_rclpy_present() and importlib.util.find_spec("ros2cli") is not None:
        return int(importlib.import_module("ros2cli.cli").main(argv=argv) or 0)
    arguments = sys.argv[1:] if argv is None else argv
    if missing := _missing(arguments):
        print(missing, file=sys.stderr)
        return 1
    if not arguments or (len(arguments) == 1 and _verbs(arguments[0])):
        arguments = [*arguments, "--help"]
    try:
        args = _parser(arguments).parse_args(arguments)
        result = args.run(args)
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115 - the reader went away; the interpreter flushes at exit
        return 0
    except Exception as error:
        result = _one_line(error)
    if isinstance(result, str):
        print(result, file=sys.stderr)
        return 1
    return int(result or 0)


def _one_line(error: Exception) -> str:
    if type(error).__name__ == "ExternalShutdownException":
        return ""
    text = str(error) or type(error).__name__
    return text if isinstance(error, CommandError) or "\n" not in text else " ".join(text.split())


def _commands() -> list[str]:
    return [info.name for info in pkgutil.iter_modules(commands.__path__) if info.name not in _HELPERS]


def _verbs(name: str) -> list[str]:
    """The verbs of a command; none where it has none, or there is no such command."""
    folders = [os.path.join(path, name) for path in commands.__path__]
    return [info.name for info in pkgutil.iter_modules(folders)] if name in _commands() else []


def _missing(arguments: list[str]) -> str:
    """What to do in place of a command or verb that is missing; empty where it is there."""
    name, verb = [*arguments[:2], "", ""][:2]
    if name in _NOT_OFFERED:
        what, instead = _NOT_OFFERED[name]
        return f"ros2: rclpy_dds does not offer {what}; {instead}"
    if name and not name.startswith("-") and name not in _commands():
        return f"ros2: there is no command {name!r}; it has {', '.join(_commands())}"
    verbs = _verbs(name)
    if verbs and verb and not verb.startswith("-") and verb not in verbs:
        like = _INSTEAD.get(f"{name} {verb}")
        instead = f"`ros2 {like}` says the like" if like else f"it has {', '.join(verbs)}; {_ROS_2}"
        return f"ros2 {name}: rclpy_dds does not offer {verb!r}; {instead}"
    return ""


def _parser(arguments: list[str]) -> argparse.ArgumentParser:
    """Return the parser with the modules the arguments need loaded: start-up time counts on a command line."""
    parser = argparse.ArgumentParser(prog="ros2", description="ros2 is an extensible command-line tool for ROS 2.")
    subparsers = parser.add_subparsers(metavar="Call `ros2 <command> -h` for more detailed usage.", required=True)
    for name in _commands():
        if arguments[0] != name and not arguments[0].startswith("-"):
            subparsers.add_parser(name)
            continue
        module, verbs = importlib.import_module(f"{commands.__name__}.{name}"), _verbs(name)
        if not verbs:
            _add(subparsers, name, module)
            continue
        about = (module.__doc__ or "").partition(": ")[2].strip(".\n")
        command = subparsers.add_parser(name, help=f"{about}: {', '.join(verbs)}", description=module.__doc__)
        inner = command.add_subparsers(metavar=f"Call `ros2 {name} <verb> -h` for more detailed usage.", required=True)
        for verb in verbs if arguments[0] == name else ():
            _add(inner, verb, importlib.import_module(f"{module.__name__}.{verb}"))
    return parser


def _add(subparsers: Any, name: str, module: ModuleType) -> None:
    summary = (module.__doc__ or "").splitlines()[0]
    parser = subparsers.add_parser(name, help=summary, description=summary)
    module.add_arguments(parser)
    parser.set_defaults(run=module.main)


if __name__ == "__main__":
    sys.exit(main())
