"""`eha export`: write the plant, or a controller made from it, with all that was found, for other tools."""

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
_STEP = 1e-4  # s
_RATE = 500  # Hz; as eha_description's controller manager

_OF = {
    "fmu": "an FMU is for 64-bit Linux and Windows, and takes the plant's own step",
    "c": "a library has no FMI, and takes the plant's own step",
    "controller": "a controller is source text with a rate of its own",
}  # why an option of another form does not fit


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "export",
        help="write the plant, or a controller made from it, for other tools",
        description="Compiles the plant's own kernel for other tools: an FMU for co-simulation on 64-bit Linux and"
        " Windows, or a C header with a static library and its sources. The compiler comes from PyPI: pip install"
        " ziglang. Or writes a controller: gains for ros2_control, and the actuator's inverse as a C function and as a"
        " Python file, which need no compiler here",
    )
    add = parser.add_argument
    add("form", choices=("fmu", "c", "controller"), help="what to write")
    add("--out", required=True, type=Path, metavar="FILE.fmu|DIR", help="the FMU, or the folder of the other forms")
    given = parser.add_mutually_exclusive_group().add_argument
    given("--nominal", type=Path, metavar="FILE", help="the plant: a parameters file in ROS 2's YAML form")
    given(
        "--from",
        dest="found",
        type=Path,
        metavar="diagnosis.json|fitted.yaml",
        help="the plant as a diagnosis found it: either of the files that it wrote",
    )
    add("--fmi", type=int, choices=(2, 3), help="of an FMU: FMI's version (default 2, which more tools read)")
    add("--target", metavar="TRIPLE", help=f"of c: processor, system and C library, such as aarch64-linux-gnu or"
        f" x86_64-windows-gnu (default {_TARGET})")  # fmt: skip
    add("--step", type=float, metavar="S", help=f"of fmu and c: the plant's step (default {_STEP:g})")
    add("--rate", type=int, metavar="HZ", help=f"of controller: commands a second (default {_RATE})")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    _check(arguments)
    from eha_core.export import exported_model, write_fmu, write_library

    step_size = _STEP if arguments.step is None else arguments.step
    if arguments.found is not None and arguments.found.suffix == ".json":
        model = exported_model(diagnosis=arguments.found, step_size=step_size)
    else:
        model = exported_model(arguments.found or arguments.nominal, step_size=step_size)
    if arguments.form == "controller":
        return _export_controller(arguments, model)
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


def _export_controller(arguments: argparse.Namespace, model: ExportedModel) -> int:
    from eha_core.export.controller import compensation, write_controller

    source = arguments.found or arguments.nominal
    origin = source.name if source else "the nominal plant"
    written = write_controller(model, arguments.out, arguments.rate or _RATE, origin)
    compensated, left = (", ".join(names) or "none" for names in compensation(model))
    print(f"{arguments.out}: {', '.join(path.name for path in written)}")
    print(f"effects compensated: {compensated}\neffects that act and are not compensated: {left}")
    return 0


def _check(arguments: argparse.Namespace) -> None:
    """Raise EhaError for what does not go together or cannot be written, before any work is done."""
    from eha_core.export.compiler import require_compiler, require_target

    form = arguments.form
    if arguments.target is not None and form != "c":
        raise EhaError(f"--target {arguments.target}: {_OF[form]}; leave it out")
    if arguments.fmi is not None and form != "fmu":
        raise EhaError(f"--fmi {arguments.fmi}: {_OF[form]}; leave it out, or export fmu")
    if arguments.step is not None and form == "controller":
        raise EhaError(f"--step {arguments.step:g}: {_OF[form]}; leave it out, or give --rate")
    if arguments.rate is not None and form != "controller":
        raise EhaError(f"--rate {arguments.rate}: {_OF[form]}; leave it out, or give --step")
    if arguments.rate is not None and not 1 <= arguments.rate <= 10_000:
        raise EhaError(f"--rate {arguments.rate}: a controller's rate is 1 to 10000 Hz")
    if form == "fmu":
        if arguments.out.suffix != ".fmu":
            raise EhaError(f"--out {arguments.out}: the name of an FMU ends in .fmu")
        require_file(arguments.out, "--out")
    else:
        require_target(arguments.target or _TARGET)
        require_folder(arguments.out, "--out")
    if form != "controller":
        require_compiler()


def _account(model: ExportedModel) -> str:
    outputs = sum(variable.causality == "output" for variable in model.variables)
    return (
        f"{model.composition}; step {model.step_size:g} s; {len(model.parameters)} parameters, {outputs} outputs\n"
        f"effects that act: {', '.join(model.acting) or 'none'}"
    )
