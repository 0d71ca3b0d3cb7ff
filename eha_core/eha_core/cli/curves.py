"""`eha curves`: find a valve's null, flow gain, overlap, hysteresis and leakage in its steady curves."""

from __future__ import annotations

import argparse
from pathlib import Path

from eha_core.cli._paths import require_recordings
from eha_core.cli._study import check_outputs, present, units_of
from eha_core.errors import EhaError
from eha_core.rig import Datum, quantity

_FOLDER = Path("out/curves")

_CONDITIONS = (
    Datum("pressure_drop", "Pa", "pressure drop over both edges of the valve during the flow curve", "70 bar", 1e3),
    Datum("supply_pressure", "Pa", "supply pressure at blocked ports, above the return line's", "210 bar", 1e4),
    Datum("rated_current", "A", "coil current at the full command, of curves over a voltage or %", "40 mA", 1e-6),
    Datum("rated_voltage", "V", "the full command, of curves over a voltage", "10 V", 1e-6),
)


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "curves",
        help="find a valve's null, flow gain, overlap, hysteresis and leakage in its steady curves",
        description="Reads tables of a valve test bench, with steady curves over the command: flow, load pressure at"
        " blocked ports, leakage. Prints the figures of ISO 10770-1 with 95 %% intervals, and the parameters of the"
        " plant that follow from them.",
        epilog="Columns are recognised by units and names. Rows are in the order of measuring: a sweep up and down"
        " shows hysteresis. `eha init-rig --curves out/curves/curves.json` puts the parameters into a nominal file.",
    )
    add = parser.add_argument
    add("files", nargs="+", type=Path, metavar="FILE", help="a table: csv, xlsx, mat and others; at most one of each"
        " kind of curve")  # fmt: skip
    add("--current", metavar="COLUMN", help="the command: a current, a voltage, or a share of the full command in %%")
    add("--flow", metavar="COLUMN", help="the control flow, with the sign of its direction")
    add("--load-pressure", nargs="+", metavar="COLUMN", help="the load pressure at blocked ports, or pressure A and"
        " pressure B")  # fmt: skip
    add("--leakage", metavar="COLUMN", help="the supply's flow at blocked ports")
    add("--unit", action="append", default=[], metavar="COLUMN=UNIT", help="a column's unit, if its name has none; may"
        " be given again")  # fmt: skip
    for datum in _CONDITIONS:
        add(f"--{datum.name.replace('_', '-')}", metavar=f"'{datum.example}'", help=datum.meaning.replace("%", "%%"))
    add("--out", type=Path, metavar="DIR", help=f"folder for curves.json and curves.png (default {_FOLDER})")
    add("--json", metavar="FILE|-", help="write the figures there (- is standard output) and no picture")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    require_recordings(arguments.files)
    check_outputs(arguments, _FOLDER)
    if len(arguments.load_pressure or ()) > 2:
        raise EhaError("--load-pressure takes one column, or pressure A and pressure B; put FILE before it")
    given = {datum.name: getattr(arguments, datum.name) for datum in _CONDITIONS}
    conditions = {datum.name: quantity(datum, given[datum.name]) for datum in _CONDITIONS if given[datum.name]}
    # loads an optimiser: bad input should be reported at once
    from eha_core.report.curves import account, as_json, write_curves
    from eha_core.studies import curves

    found = curves(
        arguments.files, command=arguments.current, flow=arguments.flow, load_pressure=arguments.load_pressure,
        leakage=arguments.leakage, units=units_of(arguments.unit, "Q=l/min"), **conditions,
    )  # fmt: skip
    return present(arguments, _FOLDER, account(found), as_json(found), lambda folder: write_curves(found, folder))
