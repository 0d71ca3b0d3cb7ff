"""`eha exam`: make recordings with concealed effects, diagnose them as a user would, and score the answers."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from eha_core.errors import EhaError

try:
    import eha_exam.command as exam_command
    from eha_exam.errors import ExamError
except ModuleNotFoundError as missing:
    if (missing.name or "").partition(".")[0] != "eha_exam":
        raise
    INSTALLED = False
else:
    INSTALLED = True

PROGRAM = "eha exam"
OWN = "eha diagnose"
DIAGNOSE = "{python} -m eha_core.cli diagnose {recording} {nominal} --json {answer} --jobs 1"
"""The command of the project's own diagnosis, as a user would type it."""
REPORT = "{python} -m eha_core.cli diagnose {recording} --out {folder}"
"""The command that writes the report of a wrong or failed case."""
MISSING = "the exam is a package of its own, which is not installed; run `pip install eha_exam`"


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb: with the options of the exam's own command, or any words where that is not installed."""
    if not INSTALLED:
        _add_placeholder(subparsers)
        return
    parser = subparsers.add_parser(
        "exam",
        help="score the diagnosis on recordings with concealed effects",
        description=__doc__,
        epilog=exam_command.tiers(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    exam_command.add_options(parser)
    parser.add_argument(
        "--real", type=Path, metavar="DIR", help="test the measured rigs below this folder, and nothing else"
    )
    parser.add_argument(
        "--bags",
        type=Path,
        metavar="DIR",
        help="diagnose the project's own recordings in this folder, and nothing else",
    )


def _add_placeholder(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """A verb that takes every option as a word, so that what is answered is what to install."""
    parser = subparsers.add_parser(
        "exam", description=f"{__doc__}\n\n{MISSING[0].upper()}{MISSING[1:]}.", prefix_chars="\0", add_help=False
    )
    parser.add_argument("words", nargs="*", help=argparse.SUPPRESS)
    parser.set_defaults(help=parser.format_help)


def run(arguments: argparse.Namespace) -> int:
    """Run the verb; the exit status is BELOW_REQUIRED where --require was not met."""
    if not INSTALLED:
        if {"-h", "--help"} & set(arguments.words):
            print(arguments.help(), end="")
            return 0
        raise EhaError(MISSING)
    try:
        if arguments.real is not None:
            return _run_real(arguments)
        if arguments.bags is not None:
            return _run_bags(arguments)
        return exam_command.run(arguments, PROGRAM, sys.argv[2:], {OWN: DIAGNOSE}, REPORT)
    except ExamError as error:
        raise EhaError(str(error)) from error


def _run_real(arguments: argparse.Namespace) -> int:
    """Test the measured rigs; --require is the required share of questions that are met."""
    from eha_core.known_answers.real import as_markdown, hold

    folder = arguments.out / "real"
    questions = hold(arguments.real, folder, lambda line: print(line, file=sys.stderr, flush=True))
    if not questions:
        return 0
    met = [question.met for question in questions]
    return _tell_table(arguments, folder, as_markdown(questions), met, "questions are met")


def _run_bags(arguments: argparse.Namespace) -> int:
    """Diagnose the project's own recordings; --require is the required share of correct answers."""
    from eha_core.known_answers.shipped import as_markdown, show_bags

    shown = show_bags(arguments.bags, exam_command.show_progress)
    right = [one.right for one in shown]
    return _tell_table(arguments, arguments.out / "bags", as_markdown(shown), right, "recordings are right")


def _tell_table(arguments: argparse.Namespace, folder: Path, table: str, right: Sequence[bool], what: str) -> int:
    """Write and print a table, and compare the share of what is right with --require."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "table.md").write_text(table, encoding="utf-8")
    print(f"{table}\ntable: {folder}/table.md")
    return exam_command.compared(sum(right) / len(right), arguments.require, what, PROGRAM)
