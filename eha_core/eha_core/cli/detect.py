"""`eha detect`: compute the smallest effects that a planned test detects, or design the test that detects some best."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eha_core.cli._study import check_outputs, present
from eha_core.errors import EhaError

# modules that simulate or plot are imported where they are used: help and errors do not need them
if TYPE_CHECKING:
    from eha_core.cli._command import Samples
    from eha_core.detectability import Certificate

_FOLDER = Path("out/detect")

USUAL = "multisine:amplitude=0.12,lowest=0.3,highest=8,count=16,period=20,seed=5"
"""The command of the example recordings, with which a designed test is compared where no other is given."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "detect",
        help="compute the smallest effects that a planned test detects",
        description="Simulates the rig as modelled under a command. For each effect of the catalogue it computes, from"
        " the diagnosis' own linearisation, the smallest size that a diagnosis names with 95 % probability, the effects"
        " that it could not distinguish, the nominal parameters that compensate for it, and the size with pressures.",
        epilog="The sizes hold for a rig that differs from the model by one effect and by parameters within their"
        " prior, with white noise. Any other difference makes all sizes larger.",
    )
    add = parser.add_argument
    add("--command", metavar="RECORDING|FILE.csv|SIGNAL", help="the voltages of a file, or a signal such"
        " as multisine:amplitude=0.12; with --for, what the designed test is compared with")  # fmt: skip
    add("--for", dest="names", metavar="NAMES", help="design the test that detects these effects or changes of nominal"
        " parameters best, such as internal_leakage,coulomb_friction")  # fmt: skip
    add("--within", type=Path, metavar="FILE", help="limits of the designed test in SI units: position, speed,"
        " pressure, energy, voltage (default: 85 %% of the stroke, 1.2 times the supply pressure, and the voltage at"
        " which the coil saturates)")  # fmt: skip
    add("--nominal", type=Path, metavar="FILE", help="the model: a parameters file in ROS 2's YAML form, or an FMU")
    add("--topics", type=Path, metavar="FILE", help="topics file that says where the voltage is recorded")
    add("--channels", default="position,pressure_a,pressure_b", metavar="NAMES", help="channels to be recorded"
        " (default %(default)s)")  # fmt: skip
    add("--noise", type=float, default=1.0, metavar="FACTOR", help="sensor noise; 1 is 10 um and 0.01 MPa (default 1)")
    add("--rate", type=float, default=500.0, metavar="HZ", help="samples a second (default 500)")
    add("--duration", type=float, metavar="S", help="length of the test (default: the command's, or 10 s)")
    add("--out", type=Path, metavar="DIR", help=f"folder for detect.json and detect.png (default {_FOLDER})")
    add("--json", metavar="FILE|-", help="write the certificate there (- is standard output) and no picture")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    check_outputs(arguments, _FOLDER)
    if arguments.names is not None:
        return _design(arguments)
    if arguments.command is None or arguments.within is not None:
        raise EhaError("give --command, or the effects of a designed test with --for; --within needs --for")
    made = _certificate(arguments)
    from eha_core.report.detectability import account, as_json, write_certificate

    return present(arguments, _FOLDER, account(made), as_json(made), lambda folder: write_certificate(made, folder))


def _design(arguments: argparse.Namespace) -> int:
    from eha_core.report.designed_test import account, as_json, write_design
    from eha_core.studies import design_test

    arguments.command = arguments.command or USUAL
    command, how = _planned(arguments)
    made = design_test(_listed(arguments.names), command, arguments.nominal, limits=arguments.within, **how)
    return present(arguments, _FOLDER, account(made), as_json(made), lambda folder: write_design(made, folder))


def _certificate(arguments: argparse.Namespace) -> Certificate:
    from eha_core.studies import detect

    command, how = _planned(arguments)
    return detect(command, arguments.nominal, **how)


def _planned(arguments: argparse.Namespace) -> tuple[Samples, dict[str, Any]]:
    """The command (instants [s] and voltages [V]), and how long and how the response is recorded."""
    from eha_core.cli._command import read_command

    times, voltages, duration = read_command(arguments, "voltage_command")
    channels = _listed(arguments.channels)
    how = {"duration": duration, "channels": channels, "noise": arguments.noise, "rate": arguments.rate}
    return (times, voltages), how


def _listed(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())
