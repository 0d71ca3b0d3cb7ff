"""`make mutants`: what the quick tests notice of small changes in the code, each tried alone.

In each group a random sample is drawn of the places that cosmic-ray can change: operators, comparisons, numbers,
conditions, loops, exceptions. At each place one change is drawn, and the group's tests are run against it in a copy of
the project. Compiled functions run as Python there, so that no cache of compiled code can answer for a changed source;
Python's own is checked against the source's hash. Decorators and type unions are left alone, and so is `==` for `is`.
"""

from __future__ import annotations

import argparse
import difflib
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from importlib import import_module
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import pytest
from cosmic_ray.commands.init import init
from cosmic_ray.modules import find_modules
from cosmic_ray.mutating import use_mutation
from cosmic_ray.plugins import get_operator
from cosmic_ray.work_db import use_db
from cosmic_ray.work_item import MutationSpec

ROOT = Path(__file__).resolve().parent.parent
COPY = ROOT / "out" / "mutants"
LIBRARY = "eha_core/eha_core"
SAME = re.compile(
    r"core/(RemoveDecorator|ReplaceBinaryOperator_BitOr|ReplaceComparisonOperator_("
    r"(Eq|NotEq|Lt|LtE|Gt|GtE)_Is|Is(Not)?_(Eq|NotEq)))"
)
"""Changes that mostly change nothing: of what is compiled and cached, of annotations, of comparisons with None."""
OPTIONS = ("-qx", "--assert=plain", "-p", "no:cacheprovider", "-o", "timeout=900")
LOADED = (
    "numpy", "scipy.signal", "scipy.optimize", "scipy.integrate", "scipy.interpolate", "scipy.ndimage", "numba",
    "pysindy", "mcap.reader", "mcap.writer", "rosbags.typesys", "rosbags.rosbag2", "yaml", "threadpoolctl",
)  # fmt: skip
"""What each run would load anew, none of it changed."""
LONGEST = 60
"""s of the processor's time for a group's tests; a change that takes more of it goes on for ever, and is noticed."""
LONGEST_WAIT = 300
"""s that they may take on the clock: a change that waits for ever takes no processor's time."""
LARGEST = 8 << 30
"""Bytes of addresses that they may use, likewise."""


class Group(NamedTuple):
    """Sources to change; the tests that are to notice, by folder and file, and pytest's choice among them."""

    sources: tuple[str, ...]
    folder: str
    files: str
    chosen: str
    beside: tuple[str, ...] = ()


GROUPS = {
    "plant": Group(
        ("plant",),
        "plant",
        "derivatives paper_bits linear lines valve active_intervals sources oil simulator cylinders parts piston"
        " one_by_one many lanes stroke_ends composite pieces",
        "not agrees_with and not of_its_own and not from_the_present and not small_signal and not made_nor_lost"
        " and not its_pitch and not any_legal and not 1e-06 and not [1- and not last_bit and not matters"
        " and not acts_in_it and not one_file and not any_pieces and not interpreter and not free_single"
        " and not valves_head and not of_sets and not in_its_lanes and not a_span and not by_pressures and not edited",
    ),
    "recording": Group(
        ("recording",),
        "recording",
        "reader writer log_files bag topic_columns csv_file samples units blocks arrays simulated introspection"
        " cdr_layout hostile_files damaged suggestions suggested_units cutting discovery clocks inspection"
        " message_types mcap_file table_file frozen mcap_summary channel_rules simulated_table unpacking"
        " topics_text",
        "not turned_over and not at_any_byte and not too_many and not killed and not its_size and not 12_to_the",
        ("tests/cli/test_inspect.py",),
    ),
    "verdict": Group(
        tuple(f"diagnosis/{name}.py" for name in ("verdict", "criteria", "conclude", "explained")),
        "diagnosis",
        "verdict criteria conclude explained summary document",
        "not true_model_predicts",
    ),
}
"""What is left out takes more than half a second of the processor's time, interpreted, or runs compiled code."""


def main() -> int:
    """Try the groups one after the other; exit status 1 where unchanged code does not pass their tests."""
    parser = argparse.ArgumentParser(prog="make mutants", description=__doc__)
    parser.add_argument("--places", type=int, default=60, help="how many of each group (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="what they are drawn from (default %(default)s)")
    parser.add_argument("--minutes", type=float, default=20.0, help="end each group then (default %(default)s)")
    parser.add_argument("groups", nargs="*", help=f"some of {', '.join(GROUPS)} (default all)")
    arguments = parser.parse_args()
    copy_project()
    os.chdir(COPY)
    sys.path[:1] = [str(COPY), str(COPY / "eha_core")]
    os.environ |= {"PYTHONPATH": str(COPY / "eha_core"), "PYTHONDONTWRITEBYTECODE": "1", "NUMBA_DISABLE_JIT": "1"}
    os.environ["EHA_CACHE_DIR"] = str(COPY / "cache")
    sys.dont_write_bytecode = True
    for module in LOADED:
        import_module(module)
    print("| group | places | tried | noticed |\n| --- | --- | --- | --- |", flush=True)
    return max([examine(name, arguments) for name in arguments.groups or GROUPS])


def copy_project() -> None:
    """The project's files as they are, in a folder where a change does no harm when it is interrupted."""
    shutil.rmtree(COPY, ignore_errors=True)
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, names.split("\0")):
        (COPY / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, COPY / name, follow_symlinks=False)
    compiled = [sys.executable, "-m", "compileall", "-q", "--invalidation-mode", "checked-hash", LIBRARY]
    subprocess.run(compiled, cwd=COPY, check=True)


def examine(name: str, arguments: argparse.Namespace) -> int:
    """Print each change that nothing noticed, then a row of the table."""
    group = GROUPS[name]
    if not passes(group, quiet=False):
        print(f"{name}: unchanged code does not pass", file=sys.stderr)
        return 1
    places = all_places(group)
    draw = random.Random(arguments.seed)
    drawn = [draw.choice(changes) for changes in draw.sample(places, min(arguments.places, len(places)))]
    end = time.monotonic() + 60.0 * arguments.minutes
    tried = missed = 0
    for change in drawn:
        if time.monotonic() > end:
            break
        tried += 1
        with use_mutation(change.module_path, get_operator(change.operator_name)(), change.occurrence) as texts:
            if passes(group, change.module_path.stem):
                missed += 1
                where = f"{change.module_path}:{change.start_pos[0]} {change.operator_name}"
                print(where, *difference(*texts), sep="\n", file=sys.stderr, flush=True)
    print(f"| {name} | {len(places)} | {tried} | {tried - missed} |", flush=True)
    return 0


def passes(group: Group, first: str = "", quiet: bool = True) -> bool:
    """Run a group's tests in a fork of this process, which has what they need of others loaded, and nothing of the
    project; those of the module `first` first."""
    names = sorted(group.files.split(), key=lambda name: name != first)
    files = [f"tests/{group.folder}/test_{name}.py" for name in names] + list(group.beside)
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST))
        signal.alarm(LONGEST_WAIT)
        resource.setrlimit(resource.RLIMIT_AS, (LARGEST, LARGEST))
        if quiet:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, 1)
            os.dup2(nowhere, 2)
        os._exit(pytest.main([*OPTIONS, *files, "-k", group.chosen]))
    return os.waitpid(child, 0)[1] == 0


def difference(before: str, after: str) -> list[str]:
    """The lines in which two texts differ."""
    return list(difflib.unified_diff(before.splitlines(), after.splitlines(), lineterm="", n=0))[3:]


def all_places(group: Group) -> list[list[MutationSpec]]:
    """Every place of a group's sources in the order of the text, with the changes that can be made there."""
    modules = sorted(find_modules([Path(LIBRARY, source) for source in group.sources]))
    with use_db(COPY / "changes.sqlite") as database:
        init(modules, database, {})
        changes = [change for item in database.work_items for change in item.mutations]
    changes = [change for change in changes if not SAME.match(change.operator_name)]
    changes.sort(key=lambda one: (one.module_path, one.start_pos, one.operator_name, one.occurrence))
    return [list(found) for _, found in groupby(changes, key=lambda one: (one.module_path, one.start_pos))]


if __name__ == "__main__":
    sys.exit(main())
