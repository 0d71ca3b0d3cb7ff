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


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "export",
        help="write the plant for tools that know no Python",
        description="Compiles the plant's own kernel for other tools: an FMU for co-simulation, or a C header with a"
        " library. Needs the compiler of ziglang: pip install ziglang==0.17.1",
    )
    forms = parser.add_subparsers(dest="form", metavar="FORM", required=True)
    fmu = forms.add_parser("fmu", help="an FMU for co-simulation, for 64-bit Linux and Windows")
    add = fmu.add_argument
    add("--fmi", type=int, choices=(2, 3), default=2, help="FMI's version (default 2, which more tools read)")
    add("--out", required=True, type=Path, metavar="FILE.fmu", help="the FMU to write")
    library = forms.add_parser("c", help="a C header with a static library for a target, and its sources")
    add = library.add_argument
    add("--target", default="x86_64-linux-gnu", metavar="TRIPLE", help="processor, system and C library, such as"
        " aarch64-linux-gnu or x86_64-windows-gnu (default %(default)s)")  # fmt: skip
    add("--out", required=True, type=Path, metavar="DIR", help="folder to write to")
    for form in (fmu, library):
        add = form.add_mutually_exclusive_group().add_argument
        add("--nominal", type=Path, metavar="FILE", help="the plant: a parameters file in ROS 2's YAML form")
        add("--from", dest="diagnosis", type=Path, metavar="diagnosis.json", help="the plant as a diagnosis found it")
        form.add_argument("--step", type=float, default=1e-4, metavar="S", help="its step (default %(default)s)")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    from eha_core.export.compiler import require_compiler, require_target

    if arguments.form == "fmu":
        require_file(arguments.out, "--out")
        if arguments.out.suffix != ".fmu":
            raise EhaError(f"--out {arguments.out}: the name of an FMU ends in .fmu")
    else:
        require_target(arguments.target)
        require_folder(arguments.out, "--out")
    require_compiler()
    from eha_core.export import exported_model, write_fmu, write_library

    model = exported_model(arguments.nominal, arguments.diagnosis, arguments.step)
    if arguments.form == "fmu":
        path = write_fmu(model, arguments.out, arguments.fmi)
        what = f"FMI {arguments.fmi}.0 co-simulation for 64-bit Linux and Windows, {path.stat().st_size / 1000:.0f} kB"
        print(f"{path}: {what}")
    else:
        written = write_library(model, arguments.out, arguments.target)
        print(f"{arguments.out}: {', '.join(str(path.relative_to(arguments.out)) for path in written)}")
        print(f"for {arguments.target}")
    print(_account(model))
    return 0


def _account(model: ExportedModel) -> str:
    outputs = sum(variable.causality == "output" for variable in model.variables)
    return (
        f"{model.composition}; step {model.step_size:g} s; {len(model.parameters)} parameters, {outputs} outputs\n"
        f"effects that act: {', '.join(model.acting) or 'none'}"
    )
