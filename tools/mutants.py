"""`python -m tools.mutants`: small changes of the library, drawn from a seed, and how many of them the tests notice.

Every mutant is a module with one operator, comparison, constant or condition changed. The tests that mirror the module
run against it, in a process forked from one that has loaded the libraries, so that a mutant costs what its tests cost.
Compiled functions are left out: their machine code is kept by the hash of the sources, and tests hold it to the bit.
"""

from __future__ import annotations

import argparse
import ast
import importlib
import importlib.abc
import importlib.util
import os
import random
import sys
from collections.abc import Iterator
from importlib.machinery import ModuleSpec
from multiprocessing import get_context
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parents[1]
LIBRARY = ROOT / "eha_core" / "eha_core"
ROOMS = {
    "plant": ("composition", "linear", "many", "plant_file", "spells", "simulator"),
    "recording": (
        "arrays", "bag", "cdr_layout", "channel_rules", "clocks", "crash_safe_file", "discovery", "fields", "mcap_file",
        "message_rows", "raw", "reader", "recording", "samples", "topic_columns", "units", "unpacking", "writer",
    ),
    "diagnosis": ("verdict",),
}  # fmt: skip
"""Modules without compiled functions, by room."""
SLOW = {"test_bags.py", "test_against_radau.py", "test_lanes.py", "test_paper_bits.py", "test_parts.py"}
LONGEST = 60
"""s of its own processor time after which a mutant counts as noticed: it hangs."""
KILLED, SURVIVED = "noticed", "survived"

SWAPS: dict[type[ast.AST], type[ast.AST]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip


def changes(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Change the tree in one place after the other: its line and what is changed, as long as it is so."""
    for node in list(_running(tree)):
        if isinstance(node, ast.Compare):
            yield from _swapped(node, node, "ops", 0)
        elif isinstance(node, (ast.BinOp, ast.BoolOp)):
            yield from _swapped(node, node, "op", None)
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float, bool):
            former = node.value
            node.value = not former if isinstance(former, bool) else former + 1
            yield node.lineno, f"{former} becomes {node.value}"
            node.value = former
        elif isinstance(node, (ast.If, ast.IfExp)):
            former_test = node.test
            node.test = ast.copy_location(ast.UnaryOp(ast.Not(), former_test), former_test)
            ast.fix_missing_locations(node.test)
            yield node.lineno, "the condition is turned round"
            node.test = former_test


def _running(tree: ast.AST) -> Iterator[ast.AST]:
    """Nodes that run: annotations and what is assigned to __all__ do not."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield child
                yield from _running(child)


def _swapped(node: ast.expr, owner: ast.AST, field: str, place: int | None) -> Iterator[tuple[int, str]]:
    former = getattr(owner, field)
    operator = former if place is None else former[place]
    other = SWAPS.get(type(operator))
    if other is None:
        return
    setattr(owner, field, other() if place is None else [other(), *former[1:]])
    yield node.lineno, f"{type(operator).__name__} becomes {other.__name__}"
    setattr(owner, field, former)


def mutant(path: Path, number: int) -> tuple[str, str]:
    """The source of a module's mutant, and where and what it is."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for count, (line, what) in enumerate(changes(tree)):
        if count == number:
            return ast.unparse(tree), f"{path.relative_to(LIBRARY)}:{line}: {what}"
    raise IndexError(number)


def tests_of(room: str, module: str) -> list[str]:
    """The tests that mirror a module; where none bears its name, all quick ones of its room."""
    folder = ROOT / "tests" / room
    own = [path for path in (folder / f"test_{module}.py", folder / f"test_{module}s.py") if path.is_file()]
    others = sorted(path for path in folder.glob("test_*.py") if path.name not in {*SLOW, *(one.name for one in own)})
    if room == "diagnosis":
        others = []
    return [str(path) for path in (*own, *others)]


class _Mutated(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Gives one module from a changed source."""

    def __init__(self, name: str, path: Path, source: str) -> None:
        self._name, self._path, self._source = name, path, source

    def find_spec(self, fullname: str, path: object = None, target: ModuleType | None = None) -> ModuleSpec | None:
        if fullname != self._name:
            return None
        return importlib.util.spec_from_file_location(fullname, self._path, loader=self)

    def exec_module(self, module: ModuleType) -> None:
        exec(compile(self._source, str(self._path), "exec"), module.__dict__)


def _built_on(name: str) -> set[str]:
    """The loaded modules of the library that took something from this one, directly or through others, and itself."""
    loaded = {key: vars(module) for key, module in sys.modules.items() if key.startswith("eha_core")}
    stale, more = {name} & set(loaded), True
    while more:
        taken = {
            key
            for key, held in loaded.items()
            if any(getattr(value, "__name__", "") in stale or getattr(value, "__module__", "") in stale
                   for value in held.values())
        }  # fmt: skip
        more = not taken <= stale
        stale |= taken
    return stale


def _run(room: str, path: Path, source: str) -> None:
    """Run the tests against a mutant, and end with 0 where they pass."""
    import resource

    import pytest

    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST))
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    name = f"eha_core.{room}.{path.stem}"
    for stale in _built_on(name):
        del sys.modules[stale]
    sys.meta_path.insert(0, _Mutated(name, path, source))
    sys.path.insert(0, str(ROOT / "tests" / room))
    os._exit(int(pytest.main([*tests_of(room, path.stem), "-x", "-q", "-p", "no:cacheprovider", "-o", "timeout=0"])))


def outcome(room: str, path: Path, source: str) -> str:
    """Whether the tests notice a mutant."""
    process = get_context("fork").Process(target=_run, args=(room, path, source))
    process.start()
    process.join()
    return SURVIVED if process.exitcode == 0 else KILLED


def main() -> int:
    """Draw mutants, try them, and say which survived."""
    parser = argparse.ArgumentParser(prog="python -m tools.mutants", description=__doc__)
    parser.add_argument("--mutants", type=int, default=40, help="mutants of each room (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="what they are drawn from (default %(default)s)")
    parser.add_argument("rooms", nargs="*", default=list(ROOMS), help=f"some of {', '.join(ROOMS)} (default all)")
    arguments = parser.parse_args()
    if unknown := [room for room in arguments.rooms if room not in ROOMS]:
        parser.error(f"there is no room {unknown[0]}; give some of {', '.join(ROOMS)}")
    for library in ("numpy", "scipy.linalg", "scipy.interpolate", "numba", "pytest", "mcap.reader", "yaml"):
        __import__(library)
    for room in arguments.rooms:
        paths = [LIBRARY / room / f"{name}.py" for name in ROOMS[room]]
        everywhere = [
            (path, number)
            for path in paths
            for number, _ in enumerate(changes(ast.parse(path.read_text(encoding="utf-8"))))
        ]
        drawn = random.Random(f"{arguments.seed} {room}").sample(everywhere, min(arguments.mutants, len(everywhere)))
        noticed = 0
        for path, number in drawn:
            source, what = mutant(path, number)
            importlib.import_module(f"eha_core.{room}.{path.stem}")  # what it needs is then loaded once for all
            found = outcome(room, path, source)
            noticed += found == KILLED
            print(f"{found}: {what}", file=sys.stderr, flush=True)
        print(f"{room}: {noticed} of {len(drawn)} mutants noticed, of {len(everywhere)}; seed {arguments.seed}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
