"""`eha steps`: read short step tests of a valve together: dead zone, gain, delay, saturation and end stops."""

from __future__ import annotations

import argparse
from pathlib import Path

from eha_core.cli._paths import require_recordings
from eha_core.cli._study import check_outputs, present, units_of

_FOLDER = Path("out/steps")


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "steps",
        help="read short step tests of a valve together: dead zone, gain, delay, saturation and end stops",
        description="Reads files in which the command is stepped from neutral to a constant level and back while a"
        " position, an angle or a velocity is recorded. Prints each step's delay, time constant and speed, and what all"
        " steps of a direction show together, with 95 %% intervals. What cannot be told is said to be open.",
        epilog="Give all files of one machine at once: several levels, and one at least without motion.",
    )
    add = parser.add_argument
    add("files", nargs="+", type=Path, metavar="FILE", help="a table (csv, xlsx, mat ...), an .mcap or .db3 file or a"
        " rosbag2 folder, with one or more steps")  # fmt: skip
    add("--command", metavar="COLUMN", help="the command: %%, a voltage, a current or a pilot pressure")
    add("--motion", metavar="COLUMN", help="the motion: a position, an angle or a velocity")
    add("--time", metavar="COLUMN", help="the time")
    add("--unit", action="append", default=[], metavar="COLUMN=UNIT", help="a column's unit, if its name has none; may"
        " be given again")  # fmt: skip
    add("--topics", type=Path, metavar="FILE", help="which topics, fields and units are which channels")
    add("--out", type=Path, metavar="DIR", help=f"folder for steps.json and steps.png (default {_FOLDER})")
    add("--json", metavar="FILE|-", help="write the figures there (- is standard output) and no picture")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    require_recordings(arguments.files)
    check_outputs(arguments, _FOLDER)
    units = units_of(arguments.unit, "boom=deg")
    # loads an optimiser: bad input should be reported at once
    from eha_core.report.steps import account, as_json, write_steps
    from eha_core.studies import steps

    found = steps(
        arguments.files, command=arguments.command, motion=arguments.motion, time=arguments.time, units=units,
        topics=arguments.topics,
    )  # fmt: skip
    return present(arguments, _FOLDER, account(found), as_json(found), lambda folder: write_steps(found, folder))
