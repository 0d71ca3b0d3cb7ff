"""Trials of drawn rigs, one line of a file for each: those that are there already are not made again."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from eha_core.workers import Workers

Trial = Callable[[int, int], dict[str, Any]]
"""A trial of rig `number` of a seed. Its row has the number as `number`."""


def alone(trial: Trial, number: int, seed: int) -> dict[str, Any]:
    """One trial, whose linear algebra takes one core."""
    with threadpool_limits(1):
        return trial(number, seed)


def try_rigs(
    trial: Trial, summed_up: Callable[[Sequence[Mapping[str, Any]]], Iterable[str]], description: str | None, rigs: int
) -> None:
    """Try the rigs that the file which the command line names lacks, and print what all of its rows come to."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rigs", type=int, default=rigs)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    rows = [json.loads(line) for line in given.out.read_text().splitlines()] if given.out.is_file() else []
    known = {row["number"] for row in rows}
    calls = [(trial, number, given.seed) for number in range(given.first, given.rigs) if number not in known]
    with given.out.open("a", encoding="utf-8") as file:
        for row in Workers(given.jobs, None).run(alone, calls):
            rows.append(row)
            file.write(json.dumps(row) + "\n")
            file.flush()
    for line in summed_up(rows):
        print(line)
