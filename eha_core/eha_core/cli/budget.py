"""`eha budget`: compute how much each effect that was found adds to the tracking error, and what its repair gains."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from eha_core.cli._paths import require_recordings
from eha_core.cli._study import check_outputs, present
from eha_core.errors import EhaError, ParameterError

# modules that simulate or plot are imported where they are used: help and errors do not need them
if TYPE_CHECKING:
    from eha_core.error_budget import Rig, Task

_FOLDER = Path("out/budget")


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "budget",
        help="compute how much each effect that was found adds to the tracking error",
        description="Simulates a motion with every subset of the effects that a diagnosis found, and divides the"
        " tracking RMSE into shares of the effects that add up to it. Prints the gain of each repair alone, and the"
        " order of repairs that reduces the error fastest.",
        epilog="The controller is designed for the rig as modelled. The error is that of the true position, whatever"
        " the sensors show; effects that acted over an interval of the recording are assumed to act always.",
    )
    add = parser.add_argument
    add("source", nargs="?", type=Path, metavar="RECORDING|diagnosis.json", help="a diagnosis, or a recording that is"
        " diagnosed first")  # fmt: skip
    add("--set", action="append", default=[], metavar="NAME=VALUE", help="in place of a diagnosis: an effect's value or"
        " a leakage that departs from the model; may be given again")  # fmt: skip
    add("--nominal", type=Path, metavar="FILE", help="the model, with a recording or --set: a parameters file")
    add("--topics", type=Path, metavar="FILE", help="which topics, fields and units of a recording are which channels")
    add("--controller", default="pid", metavar="NAME", help="pid (the default), cascade, lqr, sliding_mode or"
        " feedforward")  # fmt: skip
    add("--reference", metavar="SIGNAL", help="position to follow [m], as sine:amplitude=0.01,frequency=1")
    add("--command", metavar="SIGNAL", help="in place of controller and reference: a voltage [V], open loop; the error"
        " is then the difference from the rig as modelled")  # fmt: skip
    add("--duration", type=float, metavar="S", help="length of the motion (default 4 s, of a voltage 10 s)")
    add("--skip", type=float, metavar="S", help="seconds to ignore at the start (default 1, of a voltage 0)")
    add("--rate", type=float, default=500.0, metavar="HZ", help="commands and samples a second (default 500)")
    add("--command-limit", type=float, default=10.0, metavar="V", help="largest voltage (default 10)")
    add("--out", type=Path, metavar="DIR", help=f"folder for budget.json and budget.png (default {_FOLDER})")
    add("--json", metavar="FILE|-", help="write the budget there (- is standard output) and no picture")
    add("--jobs", type=int, default=2, metavar="N", help="threads of a diagnosis (default 2)")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    _check(arguments)
    task = _task(arguments)
    rig = _rig(arguments)
    # compiles and simulates: bad input should be reported at once
    from eha_core.error_budget import error_budget
    from eha_core.report.budget import account, as_json, write_budget

    budget = error_budget(rig, task)
    return present(arguments, _FOLDER, account(budget), as_json(budget), lambda folder: write_budget(budget, folder))


def _check(arguments: argparse.Namespace) -> None:
    """Raise EhaError for arguments that contradict each other, before any work is done."""
    if (arguments.source is None) == (not arguments.set):
        raise EhaError("give a diagnosis.json or a recording, or departures from the model with --set NAME=VALUE")
    if (arguments.reference is None) == (arguments.command is None):
        raise EhaError("give --reference SIGNAL, such as sine:amplitude=0.01,frequency=1, or --command SIGNAL")
    if arguments.source is not None:
        require_recordings([arguments.source])
        if arguments.nominal and arguments.source.suffix == ".json":
            raise EhaError(f"--nominal {arguments.nominal}: {arguments.source} has the model already; leave it out")
    check_outputs(arguments, _FOLDER)


def _task(arguments: argparse.Namespace) -> Task:
    from eha_core.studies import task_of

    follows = arguments.command is None
    return task_of(
        arguments.reference if follows else arguments.command, arguments.controller if follows else "",
        arguments.duration, arguments.skip, arguments.rate, arguments.command_limit,
    )  # fmt: skip


def _rig(arguments: argparse.Namespace) -> Rig:
    from eha_core.studies import rig_of

    if arguments.set:
        return rig_of(_changes(arguments.set), arguments.nominal)
    return rig_of(arguments.source, arguments.nominal, arguments.topics, arguments.jobs)


def _changes(words: list[str]) -> Mapping[str, float]:
    found: dict[str, float] = {}
    for word in words:
        name, _, value = word.partition("=")
        try:
            found[name] = float(value)
        except ValueError:
            raise ParameterError(f"--set {word!r} is not NAME=VALUE; write coulomb_friction.force=250") from None
    return found
