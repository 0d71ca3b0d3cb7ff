"""`eha export`: write the plant, with all that was found, for tools that know no Python."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from eha_core.cli._paths import require_file, require_folder
from eha_core.errors import EhaError

# what loads the compiled plant is imported where it is used: the help and a refusal need none of it
if TYPE_CHECKING:
    from eha_core.export import ExportedModel

_TARGET = "x86_64-linux-gnu"


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "export",
        help="write the plant for tools that know no Python",
        description="Compiles the plant's own kernel for other tools: an FMU for co-simulation on 64-bit Linux and"
        " Windows, or a C header with a static library and its sources. The compiler comes from PyPI: pip install"
        " ziglang",
    )
    add = parser.add_argument
    add("form", choices=("fmu", "c"), help="what to write")
    add("--out", required=True, type=Path, metavar="FILE.fmu|DIR", help="the FMU, or the folder of header and library")
    given = parser.add_mutually_exclusive_group().add_argument
    given("--nominal", type=Path, metavar="FILE", help="the plant: a parameters file in ROS 2's YAML form")
    given("--from", dest="diagnosis", type=Path, metavar="diagnosis.json", help="the plant as a diagnosis found it")
    add("--fmi", type=int, choices=(2, 3), help="of an FMU: FMI's version (default 2, which more tools read)")
    add("--target", metavar="TRIPLE", help=f"of c: processor, system and C library, such as aarch64-linux-gnu or"
        f" x86_64-windows-gnu (default {_TARGET})")  # fmt: skip
    add("--step", type=float, default=1e-4, metavar="S", help="the plant's step (default %(default)s)")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    _check(arguments)
    from eha_core.export import exported_model, write_fmu, write_library

    model = exported_model(arguments.nominal, arguments.diagnosis, arguments.step)
    if arguments.form == "fmu":
        path = write_fmu(model, arguments.out, arguments.fmi or 2)
        size = path.stat().st_size / 1000.0
        print(f"{path}: FMI {arguments.fmi or 2}.0 co-simulation for 64-bit Linux and Windows, {size:.0f} kB")
    else:
        written = write_library(model, arguments.out, arguments.target or _TARGET)
        print(f"{arguments.out}: {', '.join(str(path.relative_to(arguments.out)) for path in written)}")
        print(f"for {arguments.target or _TARGET}")
    print(_account(model))
    return 0


def _check(arguments: argparse.Namespace) -> None:
    """Raise EhaError for what does not go together or cannot be written, before any work is done."""
    from eha_core.export.compiler import require_compiler, require_target

    if arguments.form == "fmu":
        if arguments.target is not None:
            raise EhaError(f"--target {arguments.target}: an FMU is for 64-bit Linux and Windows; leave it out")
        if arguments.out.suffix != ".fmu":
            raise EhaError(f"--out {arguments.out}: the name of an FMU ends in .fmu")
        require_file(arguments.out, "--out")
    else:
        if arguments.fmi is not None:
            raise EhaError(f"--fmi {arguments.fmi}: a library has no FMI; leave it out, or export fmu")
        require_target(arguments.target or _TARGET)
        require_folder(arguments.out, "--out")
    require_compiler()


def _account(model: ExportedModel) -> str:
    outputs = sum(variable.causality == "output" for variable in model.variables)
    return (
        f"{model.composition}; step {model.step_size:g} s; {len(model.parameters)} parameters, {outputs} outputs\n"
        f"effects that act: {', '.join(model.acting) or 'none'}"
    )
