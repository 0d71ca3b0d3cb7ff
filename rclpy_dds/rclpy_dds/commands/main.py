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

_NOT_OFFERED = {
    "action": "actions", "component": "components", "lifecycle": "lifecycle nodes", "daemon": "the daemon",
    "doctor": "doctor", "multicast": "multicast tests", "pkg": "package tools", "security": "security", "wtf": "doctor",
}  # fmt: skip


def main(argv: list[str] | None = None) -> int:
    """Run `ros2 ARGV` and return its exit status."""
    from rclpy_dds.finder import real_rclpy_present

    if real_rclpy_present() and importlib.util.find_spec("ros2cli") is not None:
        return int(importlib.import_module("ros2cli.cli").main(argv=argv) or 0)
    arguments = sys.argv[1:] if argv is None else argv
    if arguments and arguments[0] in _NOT_OFFERED:
        print(
            f"ros2: rclpy_dds does not offer {_NOT_OFFERED[arguments[0]]}; install ROS 2 for it (https://docs.ros.org)",
            file=sys.stderr,
        )
        return 1
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


def _parser(arguments: list[str]) -> argparse.ArgumentParser:
    """Return the parser with the modules the arguments need loaded: start-up time counts on a command line."""
    parser = argparse.ArgumentParser(prog="ros2", description="ros2 is an extensible command-line tool for ROS 2.")
    subparsers = parser.add_subparsers(metavar="Call `ros2 <command> -h` for more detailed usage.", required=True)
    for info in pkgutil.iter_modules(commands.__path__):
        if info.name in ("main", "common", "values", "param_common"):
            continue
        if not arguments or arguments[0] != info.name:
            subparsers.add_parser(info.name)
            continue
        module = importlib.import_module(f"{commands.__name__}.{info.name}")
        if not info.ispkg:
            _add(subparsers, info.name, module)
            continue
        command = subparsers.add_parser(info.name, help=module.__doc__, description=module.__doc__)
        verbs = command.add_subparsers(
            metavar=f"Call `ros2 {info.name} <verb> -h` for more detailed usage.", required=True
        )
        for verb in pkgutil.iter_modules(module.__path__):
            _add(verbs, verb.name.rstrip("_"), importlib.import_module(f"{module.__name__}.{verb.name}"))
    return parser


def _add(subparsers: Any, name: str, module: ModuleType) -> None:
    summary = (module.__doc__ or "").splitlines()[0]
    parser = subparsers.add_parser(name, help=summary, description=summary)
    module.add_arguments(parser)
    parser.set_defaults(run=module.main)


if __name__ == "__main__":
    sys.exit(main())
