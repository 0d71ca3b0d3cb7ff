"""Development cases: recordings whose answers are known, on which a change of the search is measured case by case.

    python -m tools.development make --table tools/opened_cases.json --out DIR [--cases 200] [--jobs 2]
    python -m tools.development answer --out DIR --name new [--part 0/2]
    python -m tools.development pair --out DIR --table tools/opened_cases.json --name new
    python -m tools.development steps --out DIR --name new

A table of marks of an opened exam says which cases there are, what the oracle saw in them, and how they were answered
then; so a recording is made without asking the oracle again, which takes most of the time. Cases are kept in a folder
outside the repository, an answer is a file, and what is there is not done again. CPU seconds are those of one process.
"""

from __future__ import annotations

import argparse
import json
import signal
import time
import traceback
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from types import FrameType
from typing import Any

from eha_core.api import known_model
from eha_core.diagnosis.pipeline import diagnose_together
from eha_core.recording import read_recording
from eha_core.report.document import document
from eha_core.workers import Workers
from eha_exam import cases
from eha_exam.case import Case
from eha_exam.drawing import LOAD, draw_case
from eha_exam.files import answer_text, further_name, read_answer, recording_name, write_case, write_nominal
from eha_exam.measuring import measure, simulate_case
from eha_exam.scoring import Answer, mark
from eha_exam.second import with_other_loads

LIMIT = 240.0
"""CPU seconds after which an answer counts as none."""

MADE_WITH_THE_ORACLE = ("refit", "twins")
"""Tiers whose recordings depend on what the oracle says."""


class TooLate(BaseException):
    """An answer took more than LIMIT."""


def make_development_case(name: str, seed: int, known: Mapping[str, Any], folder: str) -> str:
    """Make a case's recording and its answer in a folder, unless they are there."""
    tier, _, number = name.rpartition("-")
    sealed, recordings = Path(folder) / "sealed" / f"{name}.json", Path(folder) / "recordings"
    if sealed.is_file():
        return name
    case = draw_case(tier, int(number), seed)
    if tier in MADE_WITH_THE_ORACLE:
        case, arrays = cases.make_case(tier, int(number), seed)
    else:
        arrays = measure(case, simulate_case(case))
        case = replace(case, decidable=known["decidable"], seen=tuple(known["seen"]))
    recordings.mkdir(parents=True, exist_ok=True)
    first = recordings / recording_name(case)
    for number_of, some in enumerate((arrays, *with_other_loads(case)), 1):
        path = first.with_name(further_name(first.name, number_of))
        path.unlink(missing_ok=True)
        write_case(case, some, path)
    if case.loads:
        write_nominal(case.nominal, first.with_suffix(".yaml"), [f"{LOAD}.force"])
    sealed.parent.mkdir(exist_ok=True)
    sealed.write_text(answer_text(case), encoding="utf-8")
    return name


def answer(case: Case, recordings: Path) -> dict[str, Any]:
    """How the diagnosis answers a case: its mark, CPU seconds, the sets that it states, and its steps."""
    first = recordings / recording_name(case)
    count = 1 + len(case.loads)
    paths = [first.with_name(further_name(first.name, number)) for number in range(1, count + 1)]
    nominal = first.with_suffix(".yaml")
    began, found, message = time.process_time(), None, ""
    signal.signal(signal.SIGVTALRM, _too_late)
    signal.setitimer(signal.ITIMER_VIRTUAL, LIMIT)
    try:
        records = [read_recording(path) for path in paths]
        model = known_model(nominal if nominal.is_file() else None, records[0])
        found = document(diagnose_together(records, model, jobs=1))
    except TooLate:
        message = f"took more than {LIMIT:g} s of CPU time"
    except Exception:  # a search that fails on a case has not answered it, and the next case is asked
        message = traceback.format_exc()[-2000:]
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    seconds = time.process_time() - began
    row = asdict(mark(case, Answer(found, 0 if found else 1, seconds, message)))
    return row | {
        "cpu_s": seconds,
        "message": message,
        "sets": (found or {}).get("sets", []),
        "trace": (found or {}).get("trace", []),
    }


def _too_late(signal_number: int, frame: FrameType | None) -> None:
    raise TooLate


def in_turn(names: Sequence[str]) -> list[str]:
    """The cases in an order in which every tier comes early."""
    tiers: dict[str, list[str]] = {}
    for name in sorted(names):
        tiers.setdefault(name.rpartition("-")[0], []).append(name)
    ordered = []
    while any(tiers.values()):
        for waiting in tiers.values():
            share = -(-len(waiting) // 8)
            ordered += waiting[:share]
            del waiting[:share]
    return ordered


def paired(before: Mapping[str, Mapping[str, Any]], after: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """The table of two states' answers to the same cases, tier by tier, and each case that only one has right."""
    both = sorted(before.keys() & after.keys())
    yield f"| tier | cases | right before | right after | median CPU s after | longest |\n{'|---' * 6}|"
    for tier in ("all", *dict.fromkeys(name.rpartition("-")[0] for name in both)):
        some = [name for name in both if tier in ("all", name.rpartition("-")[0])]
        right = [sum(rows[name]["outcome"] == "right" for name in some) for rows in (before, after)]
        seconds = sorted(after[name]["cpu_s"] for name in some)
        yield f"| {tier} | {len(some)} | {right[0]} | {right[1]} | {seconds[len(some) // 2]:.1f} | {seconds[-1]:.0f} |"
    for name in both:
        outcomes = before[name]["outcome"], after[name]["outcome"]
        if (outcomes[0] == "right") != (outcomes[1] == "right"):
            named = " + ".join(after[name]["named"]) or after[name]["verdict"]
            yield f"{name}: {outcomes[0]} before, {outcomes[1]} after ({' + '.join(after[name]['concealed'])}: {named})"


def brought(answers: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """The table of what each step of the search brings: the cases in which it fitted, how many sets, the CPU time since
    the fit before, and the right answers whose set it was the first to fit."""
    steps: dict[str, list[float]] = {}
    for row in answers.values():
        before, seen, waiting = 0.0, set[str](), row["outcome"] == "right"
        for fitted in row["trace"]:
            step = fitted["step"].rstrip("0123456789 ")
            counts = steps.setdefault(step, [0, 0, 0.0, 0])
            counts[0] += step not in seen
            counts[1] += 1
            counts[2] += fitted["cpu_s"] - before
            if waiting and sorted(fitted["set"]) == sorted(row["named"]):
                counts[3] += 1
                waiting = False
            before = fitted["cpu_s"]
            seen.add(step)
    yield f"| step | cases | fits | CPU s | right sets |\n{'|---' * 5}|"
    for step, (cases_of, fits, seconds, first) in sorted(steps.items(), key=lambda item: -item[1][3]):
        yield f"| {step} | {cases_of} | {fits} | {seconds:.0f} | {first} |"


def _marks(table: Path, cases_at_most: int) -> tuple[int, dict[str, Any]]:
    read = json.loads(table.read_text(encoding="utf-8"))
    marks = read["tools"]["eha diagnose"]["marks"][:cases_at_most]
    return int(read["about"]["seed"]), {row["name"]: row for row in marks}


def main() -> None:
    """Make, answer, pair, or say what each step brought."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("make", "answer", "pair", "steps"))
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--table", type=Path)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--name", default="new")
    parser.add_argument("--part", default="0/1")
    given = parser.parse_args()
    if given.what == "make":
        seed, marks = _marks(given.table, given.cases)
        calls = [(name, seed, row, str(given.out)) for name, row in marks.items()]
        for done, name in enumerate(Workers(given.jobs, None).run(make_development_case, calls), 1):
            print(f"{done} of {len(calls)}: {name}", flush=True)
    if given.what == "answer":
        part, parts = (int(word) for word in given.part.split("/"))
        folder = given.out / "answers" / given.name
        folder.mkdir(parents=True, exist_ok=True)
        for name in in_turn([path.stem for path in (given.out / "sealed").glob("*.json")])[part::parts]:
            if not (folder / f"{name}.json").is_file():
                case = read_answer((given.out / "sealed" / f"{name}.json").read_text(encoding="utf-8"))
                row = answer(case, given.out / "recordings")
                (folder / f"{name}.json").write_text(json.dumps(row), encoding="utf-8")
                print(f"{name}: {row['outcome']} in {row['cpu_s']:.1f} s, {' + '.join(row['named'])}", flush=True)
    if given.what in ("pair", "steps"):
        answers = {path.stem: json.loads(path.read_text()) for path in (given.out / "answers" / given.name).glob("*")}
        table = paired(_marks(given.table, 10**6)[1], answers) if given.what == "pair" else brought(answers)
        for line in table:
            print(line)


if __name__ == "__main__":
    main()
