"""`eha paper`: reproduce the published tables and figures from the library alone."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from eha_core.errors import EhaError
from eha_core.paper import LEFT_OPEN, as_json, as_markdown, reproduce


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb to the command line."""
    parser = subparsers.add_parser(
        "paper",
        help="reproduce the published tables and figures",
        description="Computes Tables 2 and 3 and Figures 3 to 5 of the paper; compares them with the printed values.",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("out/paper"),
        metavar="DIR",
        help="folder for table.json and figures/ (default: %(default)s)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Compute, write and print the reproduction."""
    # Plotting loads slowly; no other verb should wait for it.
    from eha_core.report.paper_figures import draw_paper_figures

    reproduction = reproduce()
    table = arguments.out / "table.json"
    try:
        arguments.out.mkdir(parents=True, exist_ok=True)
        table.write_text(json.dumps(as_json(reproduction.levels), indent=2) + "\n", encoding="utf-8")
        figures = draw_paper_figures(reproduction.levels, arguments.out / "figures", reproduction.sweep)
    except OSError as error:
        raise EhaError(f"{error.filename}: cannot write: {error.strerror}; give another folder with --out") from error
    command = reproduction.experiment.command
    print(as_markdown(reproduction.levels))
    print(
        f"\nOpen loop, {command.amplitude * 1e3:g} mV at {command.frequency:g} Hz,"
        f" {reproduction.experiment.duration:g} s, step {reproduction.experiment.step_size:g} s."
    )
    print("\nNot stated in the paper, and assumed here:")
    print("\n".join(f"- {sentence}" for sentence in LEFT_OPEN))
    print(f"\n{table}, and {len(figures)} figures in {arguments.out / 'figures'}")
    return 0
