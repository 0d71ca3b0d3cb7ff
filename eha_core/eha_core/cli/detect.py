"""`eha detect`: say how small an effect a planned test shows, and what it cannot distinguish."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from eha_core.cli._study import check_outputs, present

# what simulates or plots is imported where it is used: the help and a refusal need none of it
if TYPE_CHECKING:
    from eha_core.detectability import Certificate

_FOLDER = Path("out/detect")


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "detect",
        help="say how small an effect a planned test shows",
        description="Simulates the rig as modelled under a command and says, from the diagnosis' own linearisation, for"
        " each effect of the catalogue the smallest size that a diagnosis names with 95 % probability, which effects it"
        " could not distinguish, which nominal parameters compensate for them, and what the pressures would bring.",
        epilog="It holds for a rig that is as modelled but for one effect and for parameters within their prior, with"
        " white noise. What else a rig has makes all sizes larger.",
    )
    add = parser.add_argument
    add("--command", required=True, metavar="RECORDING|FILE.csv|SIGNAL", help="the voltages of a file, or a signal such"
        " as multisine:amplitude=0.12")  # fmt: skip
    add("--nominal", type=Path, metavar="FILE", help="the model: a parameters file in ROS 2's YAML form")
    add("--topics", type=Path, metavar="FILE", help="topics file that says where the voltage is recorded")
    add("--channels", default="position,pressure_a,pressure_b", metavar="NAMES", help="what is to be recorded"
        " (default %(default)s)")  # fmt: skip
    add("--noise", type=float, default=1.0, metavar="FACTOR", help="sensor noise; 1 is 10 um and 0.01 MPa (default 1)")
    add("--rate", type=float, default=500.0, metavar="HZ", help="samples a second (default 500)")
    add("--duration", type=float, metavar="S", help="length of the test (default: the command's, or 10 s)")
    add("--out", type=Path, metavar="DIR", help=f"folder for detect.json and detect.png (default {_FOLDER})")
    add("--json", metavar="FILE|-", help="write the certificate there (- is standard output) and no picture")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    check_outputs(arguments, _FOLDER)
    made = _certificate(arguments)
    from eha_core.report.detectability import account, as_json, write_certificate

    return present(arguments, _FOLDER, account(made), as_json(made), lambda folder: write_certificate(made, folder))


def _certificate(arguments: argparse.Namespace) -> Certificate:
    from eha_core.cli._command import read_command
    from eha_core.studies import detect

    times, voltages, duration = read_command(arguments, "voltage_command")
    channels = tuple(name.strip() for name in arguments.channels.split(",") if name.strip())
    return detect(
        (times, voltages), arguments.nominal, duration=duration, channels=channels, noise=arguments.noise,
        rate=arguments.rate,
    )  # fmt: skip
