"""`eha init-rig`: make a rig's nominal file from data-sheet values."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from eha_core.errors import EhaError
from eha_core.parameters import effect_names
from eha_core.plant import PAPER, composition_of
from eha_core.plant.parts import parts
from eha_core.rig import DATA, Datum, asked_of, measured_entries, nominal_text, parameters_of, quantity


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "init-rig",
        help="make a rig's nominal file from data-sheet values",
        description=__doc__,
        epilog="Write values with their unit, as in --bore 40mm. On a terminal and without any value, each is asked"
        " for; Enter leaves it unknown, which `eha diagnose --nominal` accepts.",
    )
    add = parser.add_argument
    add("--out", type=Path, required=True, metavar="FILE", help="the nominal file that is written")
    add("--ask", action="store_true", help="ask for values that no option gives, also if the answers come from a pipe")
    add("--assume", action="store_true", help="write the catalogue's value, marked as assumed, in place of unknown,"
        " and put measured effects in force, as a simulation needs it")  # fmt: skip
    known = parts("source")
    what = ", ".join(f"{name} ({known[name].summary})" for name in sorted(known))
    default = PAPER.source.id
    what = f"what drives the piston: {what}; default {default}"
    add("--source", choices=sorted(known), default=default, metavar="SOURCE", help=what)
    of_curves = "a curves.json of `eha curves`: the valve's flow gain, null and other parameters as measured"
    add("--curves", type=Path, metavar="FILE", help=of_curves)
    for datum in DATA:
        add(f"--{datum.name.replace('_', '-')}", metavar=f"'{datum.example}'", help=datum.meaning.replace("%", "%%"))


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    if arguments.out.exists():
        raise EhaError(f"{arguments.out}: exists already; choose another name")
    texts = {datum.name: getattr(arguments, datum.name) for datum in DATA}
    given = {datum.name: quantity(datum, texts[datum.name]) for datum in DATA if texts[datum.name] is not None}
    composition = composition_of({"source": arguments.source})
    asked = asked_of(composition)
    idle = next((name for name in given if name not in [datum.name for datum in asked]), None)
    if idle is not None:
        raise EhaError(f"--{idle.replace('_', '-')} does not apply to a rig on {arguments.source}; leave it out")
    measured = measured_entries(arguments.curves, given.get("rated_current")) if arguments.curves else []
    if arguments.ask or (sys.stdin.isatty() and not given and not measured):
        given |= _asked([datum for datum in asked if datum.name not in given])
    entries = parameters_of(given, composition, measured)
    text = nominal_text(entries, arguments.assume, composition)
    try:
        with arguments.out.open("x", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        raise EhaError(f"{arguments.out}: cannot be written ({error.strerror}); choose another --out") from error
    print(text, end="")
    in_force = [entry for entry in entries if arguments.assume or entry.name not in effect_names()]
    unknown = [] if arguments.assume else [entry.name for entry in entries if entry.value is None]
    print(f"\n{arguments.out}: {len(in_force) - len(unknown)} values, {len(unknown)} unknown")
    print(f"Go on with: eha diagnose RECORDING --nominal {arguments.out}")
    return 0


def _asked(data: list[Datum]) -> dict[str, float]:
    """The user's answers; a wrong one is asked again, Enter and the end of the input mean unknown."""
    print("Give each value with its unit; Enter if it is not known.", file=sys.stderr)
    answers: dict[str, float] = {}
    for datum in data:
        while True:
            print(f"{datum.meaning} [{datum.example}]: ", end="", file=sys.stderr, flush=True)
            line = sys.stdin.readline()
            if not line:
                return answers
            if not line.strip():
                break
            try:
                answers[datum.name] = quantity(datum, line)
            except EhaError as error:
                print(f"  {error}", file=sys.stderr)
                continue
            break
    return answers
