"""`eha exam`: make recordings with concealed effects, diagnose them as a user would, and score the answers."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from eha_core.errors import EhaError
from eha_core.workers import Workers
from eha_exam.peers import PEERS
from eha_exam.tiers import MEANINGS

if TYPE_CHECKING:
    from eha_exam.scoring import Mark
    from eha_exam.shares import Summary

OWN = "eha diagnose"
DIAGNOSE = "{python} -m eha_core.cli diagnose {recording} {nominal} --json {answer} --jobs 1"
"""The command of the project's own diagnosis, as a user would type it."""
BELOW_REQUIRED = 1
"""Exit status where the score is below --require."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    width = max(map(len, MEANINGS))
    tiers = "\n".join(f"  {tier:{width}s} {meaning}" for tier, meaning in MEANINGS.items())
    parser = subparsers.add_parser(
        "exam",
        help="score the diagnosis on recordings with concealed effects",
        description=__doc__,
        epilog=f"tiers:\n{tiers}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--cases", type=int, default=100, metavar="N", help="number of recordings (default 100)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="seed of the exam (default 0)")
    parser.add_argument(
        "--opened", type=int, default=0, metavar="N", help="skip the first N cases of the seed: their results are known"
    )
    parser.add_argument("--tier", metavar="T", help="one tier alone")
    parser.add_argument("--jobs", type=int, default=1, metavar="J", help="recordings diagnosed in parallel (default 1)")
    parser.add_argument("--dask", metavar="ADDRESS", help="a Dask scheduler whose workers see --out")
    parser.add_argument("--out", type=Path, default=Path("out/exam"), metavar="DIR", help="folder (default out/exam)")
    parser.add_argument("--peers", action="store_true", help="score the other methods on the same recordings too")
    parser.add_argument(
        "--tool",
        action="append",
        default=[],
        metavar="NAME=COMMAND",
        help="score another tool too; {recording} and {answer} in its command are replaced by paths",
    )
    parser.add_argument(
        "--real", type=Path, metavar="DIR", help="test the measured rigs below this folder, and nothing else"
    )
    parser.add_argument(
        "--bags",
        type=Path,
        metavar="DIR",
        help="diagnose the project's own recordings in this folder, and nothing else",
    )
    parser.add_argument(
        "--lost", type=int, default=0, metavar="N", help="write reports of the first N wrong or failed cases"
    )
    parser.add_argument(
        "--pool",
        type=Path,
        nargs="+",
        metavar="TABLE",
        help="score the table.json of several runs of one exam together, and diagnose nothing",
    )
    parser.add_argument("--require", type=float, metavar="SHARE", help="fail when fewer of all cases are right")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb; the exit status is BELOW_REQUIRED where --require was not met."""
    if arguments.real is not None:
        return _run_real(arguments)
    if arguments.bags is not None:
        return _run_bags(arguments)
    if arguments.pool is not None:
        return _run_pooled(arguments)
    # The truth's integrator and compiler load slowly; no other verb should wait for them.
    from eha_exam.run_exam import Exam, report_lost, run_exam
    from eha_exam.shares import summarise

    if arguments.cases < 1 or arguments.jobs < 1:
        raise EhaError(f"--cases {arguments.cases} --jobs {arguments.jobs}: give 1 or more of each")
    if arguments.opened < 0:
        raise EhaError(f"--opened {arguments.opened}: give 0 or more")
    exam = Exam(arguments.out, arguments.cases, arguments.seed, arguments.tier, arguments.opened)
    tools = _tools(arguments)
    marks = run_exam(exam, tools, Workers(arguments.jobs, arguments.dask), _show)
    summaries = [summarise(tool, marks[tool]) for tool in tools]
    reports = report_lost(exam, summaries[0].lost[: arguments.lost])
    about = {"commit": _commit(), "cases": arguments.cases, "seed": arguments.seed}
    return _tell(arguments, summaries, marks, about, reports)


def _run_pooled(arguments: argparse.Namespace) -> int:
    """Score several runs of one exam together; --require is the required share of correct cases."""
    from eha_exam.shares import summarise
    from eha_exam.sittings import read_sittings

    marks, shared = read_sittings(arguments.pool)
    summaries = [summarise(tool, marks[tool]) for tool in marks]
    about = {**shared, "cases": summaries[0].rows[0].cases}
    arguments.out.mkdir(parents=True, exist_ok=True)
    return _tell(arguments, summaries, marks, about)


def _tell(
    arguments: argparse.Namespace,
    summaries: Sequence[Summary],
    marks: Mapping[str, Sequence[Mark]],
    about: Mapping[str, object],
    reports: Mapping[str, str] | None = None,
) -> int:
    """Write the tables, print the shares, and compare them with --require."""
    from eha_exam.page import as_html
    from eha_exam.tables import as_json, as_markdown

    command = " ".join(["eha", "exam", *sys.argv[2:]])
    about = {"command": command, **about, "plants and recordings": "simulated by the exam's own truth"}
    for name, text in (
        ("table.md", as_markdown(summaries, about)),
        ("table.json", as_json(summaries, marks, about)),
        ("table.html", as_html(summaries, marks, about, reports or {})),
    ):
        (arguments.out / name).write_text(text, encoding="utf-8")
    for summary in summaries:
        _print_summary(summary)
    print(f"tables: {arguments.out}/table.md, table.json, table.html")
    return _compared(arguments, summaries[0].rows[0].right.value or 0.0, "cases are right")


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

    shown = show_bags(arguments.bags, _show)
    right = [one.right for one in shown]
    return _tell_table(arguments, arguments.out / "bags", as_markdown(shown), right, "recordings are right")


def _tell_table(arguments: argparse.Namespace, folder: Path, table: str, right: Sequence[bool], what: str) -> int:
    """Write and print a table, and compare the share of what is right with --require."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "table.md").write_text(table, encoding="utf-8")
    print(f"{table}\ntable: {folder}/table.md")
    return _compared(arguments, sum(right) / len(right), what)


def _compared(arguments: argparse.Namespace, share: float, what: str) -> int:
    if arguments.require is not None and share < arguments.require:
        print(f"eha exam: {share:.3f} of the {what}, below --require {arguments.require}", file=sys.stderr)
        return BELOW_REQUIRED
    return 0


def _tools(arguments: argparse.Namespace) -> dict[str, str]:
    tools = {OWN: DIAGNOSE}
    if arguments.peers:
        tools |= PEERS
    for entry in arguments.tool:
        name, separator, command = entry.partition("=")
        if not separator or "{recording}" not in command or "{answer}" not in command:
            raise EhaError(f"--tool {entry!r}: give NAME=COMMAND with {{recording}} and {{answer}} in the command")
        tools[name] = command
    return tools


def _show(stage: str, done: int, of: int) -> None:
    end = "\n" if done == of else ""
    print(f"\r{stage}: {done} of {of}", end=end, file=sys.stderr, flush=True)


def _print_summary(summary: Summary) -> None:
    print(f"\n{summary.tool}")
    for row in summary.rows:
        print(
            f"  {row.group:28s} right {row.right!s:34s} "
            f"abstained {row.abstained.successes:4d}  wrong {row.wrong.successes:4d}"
        )


def _commit() -> str:
    """The commit the exam ran on, where it runs from a git checkout."""
    try:
        here = Path(__file__).parent
        command = ["git", "-C", str(here), "rev-parse", "--short", "HEAD"]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "not a git checkout"
