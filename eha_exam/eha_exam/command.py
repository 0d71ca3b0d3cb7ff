"""`eha-exam`: have methods diagnose recordings of rigs with concealed effects, and score the answers.

A tool is a command that is called once for each recording, a method one that is called once for a folder of them.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from eha_exam.errors import ExamError
from eha_exam.peers import PEERS
from eha_exam.tiers import MEANINGS
from eha_exam.version import __version__

if TYPE_CHECKING:
    from eha_exam.scoring import Mark
    from eha_exam.shares import Summary

PROGRAM = "eha-exam"
BELOW_REQUIRED = 1
"""Exit status where the score is below --require."""
UNUSABLE = 2
"""Exit status where the input or the arguments cannot be used."""
_INTERRUPTED = 130


class _Parser(argparse.ArgumentParser):
    """Reports wrong arguments in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(UNUSABLE, f"{self.prog}: {message}; see `{self.prog} --help`\n")


def tiers() -> str:
    """The tiers with their meanings, for the end of a help."""
    width = max(map(len, MEANINGS))
    return "tiers:\n" + "\n".join(f"  {tier:{width}s} {meaning}" for tier, meaning in MEANINGS.items())


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of an exam."""
    parser.add_argument("--cases", type=int, default=100, metavar="N", help="number of recordings (default 100)")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="seed of the exam (default 0)")
    parser.add_argument(
        "--opened", type=int, default=0, metavar="N", help="skip the first N cases of the seed: their results are known"
    )
    parser.add_argument("--tier", metavar="T", help="one tier alone")
    parser.add_argument(
        "--set", type=Path, metavar="FOLDER", help="score the sealed set in this folder; nothing is simulated"
    )
    parser.add_argument("--jobs", type=int, default=1, metavar="J", help="recordings diagnosed in parallel (default 1)")
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
        "--method",
        action="append",
        default=[],
        metavar="NAME=COMMAND",
        help="score another method too, called once; {recordings} and {answers} in its command are replaced by folders",
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


def run(
    arguments: argparse.Namespace,
    program: str,
    words: Sequence[str],
    own: Mapping[str, str] | None = None,
    report: str = "",
) -> int:
    """Run an exam; the exit status is BELOW_REQUIRED where --require was not met.

    Args:
        arguments: of the options that `add_options` adds.
        program, words: how it was called, which the table states.
        own: tools that are always scored, by name; --require and --lost are about the first of all.
        report: the command that writes the report of a wrong or failed case, as `report_lost` takes it.
    """
    called = (program, *words)
    if arguments.pool is not None:
        return _run_pooled(arguments, called)
    # The truth's integrator and compiler load slowly; nothing else should wait for them.
    from eha_exam.exam_folder import Exam
    from eha_exam.run_exam import report_lost, run_exam
    from eha_exam.sealed_set import exam_of
    from eha_exam.shares import summarise

    _check(arguments, report)
    tools = {**(own or {}), **(PEERS if arguments.peers else {}), **_commands(arguments.tool, "--tool", TOOL_WORDS)}
    methods = _commands(arguments.method, "--method", METHOD_WORDS)
    if both := tools.keys() & methods.keys():
        raise ExamError(f"--method {', '.join(both)}: is the name of a tool too; give another")
    if not tools and not methods:
        raise ExamError("nothing to score; give --tool NAME=COMMAND, --method NAME=COMMAND or --peers")
    if arguments.set is None:
        exam = Exam(arguments.out, arguments.cases, arguments.seed, arguments.tier, arguments.opened)
    else:
        exam = exam_of(arguments.set, arguments.out)
    marks = run_exam(exam, tools, arguments.jobs, show_progress, methods)
    summaries = [summarise(name, marks[name]) for name in marks]
    reports = report_lost(exam, summaries[0].lost[: arguments.lost], report)
    about = {"commit": _commit(), "cases": exam.cases, "seed": exam.seed}
    return _tell(arguments, called, summaries, marks, about, reports)


def _check(arguments: argparse.Namespace, report: str) -> None:
    if arguments.cases < 1 or arguments.jobs < 1:
        raise ExamError(f"--cases {arguments.cases} --jobs {arguments.jobs}: give 1 or more of each")
    if arguments.opened < 0:
        raise ExamError(f"--opened {arguments.opened}: give 0 or more")
    if arguments.set is not None and (arguments.tier or arguments.opened):
        raise ExamError("--set is scored whole; leave --tier and --opened out")
    if arguments.lost and not report:
        raise ExamError(f"--lost {arguments.lost}: no command writes reports; give --report COMMAND, or leave it out")


def _run_pooled(arguments: argparse.Namespace, called: Sequence[str]) -> int:
    """Score several runs of one exam together; --require is the required share of correct cases."""
    from eha_exam.shares import summarise
    from eha_exam.sittings import read_sittings

    marks, shared = read_sittings(arguments.pool)
    summaries = [summarise(tool, marks[tool]) for tool in marks]
    about = {**shared, "cases": summaries[0].rows[0].cases}
    arguments.out.mkdir(parents=True, exist_ok=True)
    return _tell(arguments, called, summaries, marks, about, {})


def _tell(
    arguments: argparse.Namespace,
    called: Sequence[str],
    summaries: Sequence[Summary],
    marks: Mapping[str, Sequence[Mark]],
    about: Mapping[str, object],
    reports: Mapping[str, str],
) -> int:
    """Write the tables, print the shares, and compare them with --require."""
    from eha_exam.page import as_html
    from eha_exam.tables import as_json, as_markdown

    about = {"command": " ".join(called), **about, "plants and recordings": "simulated by the exam's own truth"}
    for name, text in (
        ("table.md", as_markdown(summaries, about)),
        ("table.json", as_json(summaries, marks, about)),
        ("table.html", as_html(summaries, marks, about, reports)),
    ):
        (arguments.out / name).write_text(text, encoding="utf-8")
    for summary in summaries:
        _print_summary(summary)
    print(f"tables: {arguments.out}/table.md, table.json, table.html")
    right = summaries[0].rows[0].right.value or 0.0
    return compared(right, arguments.require, "cases are right", called[0])


def compared(share: float, required: float | None, what: str, program: str) -> int:
    """The exit status of a share of what is right, compared with the one that is required (None: any)."""
    if required is not None and share < required:
        print(f"{program}: {share:.3f} of the {what}, below --require {required}", file=sys.stderr)
        return BELOW_REQUIRED
    return 0


TOOL_WORDS = ("{recording}", "{answer}")
METHOD_WORDS = ("{recordings}", "{answers}")


def _commands(entries: Sequence[str], option: str, wanted: Sequence[str]) -> dict[str, str]:
    commands = {}
    for entry in entries:
        name, _, command = entry.partition("=")
        if not name or not all(word in command for word in wanted):
            raise ExamError(f"{option} {entry!r}: give NAME=COMMAND with {' and '.join(wanted)} in the command")
        commands[name] = command
    return commands


def show_progress(stage: str, done: int, of: int) -> None:
    """Write a stage's progress over the last line of stderr."""
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


def main(words: Sequence[str] | None = None) -> int:
    """Run `eha-exam` and return its exit status; `words` defaults to those of the process."""
    words = sys.argv[1:] if words is None else words
    parser = _Parser(
        prog=PROGRAM, description=__doc__, epilog=tiers(), formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--version", action="version", version=f"{PROGRAM} {__version__}")
    add_options(parser)
    parser.add_argument(
        "--report",
        default="",
        metavar="COMMAND",
        help="what --lost calls; {recording} and {folder} are replaced, and it writes report.html in that folder",
    )
    arguments = parser.parse_args(words)
    try:
        status = run(arguments, PROGRAM, words, report=arguments.report)
    except ExamError as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return UNUSABLE
    except KeyboardInterrupt:
        print(f"{PROGRAM}: interrupted", file=sys.stderr)
        return _INTERRUPTED
    return status


if __name__ == "__main__":
    sys.exit(main())
