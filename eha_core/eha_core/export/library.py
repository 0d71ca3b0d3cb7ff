"""The plant for a C program: a header, its sources and a static library for one target."""

from __future__ import annotations

import shutil
import tempfile
from importlib import resources
from pathlib import Path

from eha_core.errors import EhaError
from eha_core.export.compiler import archive, compile_c, require_compiler, require_target
from eha_core.export.kernel import kernel_text
from eha_core.export.model import ExportedModel
from eha_core.export.tables import header_text, tables_text

LIBRARY = "libeha_plant.a"
KERNEL, PLANT = "eha_kernel.ll", "eha_plant.c"


def write_sources(model: ExportedModel, folder: Path, *more: str) -> None:
    """Write all that the plant is compiled from into a folder, and `more` files of `c/`."""
    for name in (PLANT, "eha_plant.h", *more):
        text = (resources.files("eha_core.export") / "c" / name).read_text(encoding="utf-8")
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "eha_model.h").write_text(header_text(model), encoding="utf-8")
    (folder / "eha_tables.h").write_text(tables_text(model), encoding="utf-8")
    (folder / KERNEL).write_text(kernel_text(), encoding="utf-8")


def write_library(model: ExportedModel, folder: Path, target: str) -> tuple[Path, ...]:
    """Write `eha_plant.h` and `eha_model.h`, the static library for a target as zig names it, and its sources.

    Returns the files. Raises EhaError where ziglang is missing, the target is unknown or not of 64 bits, or the folder
    cannot be written to.
    """
    require_target(target)
    require_compiler()
    with tempfile.TemporaryDirectory() as made:
        draft = Path(made)
        write_sources(model, draft)
        objects = []
        for name in (KERNEL, PLANT):
            objects.append(f"{name}.o")
            compile_c(draft, target, ["-c", name, "-o", objects[-1]])
        archive(draft, target, LIBRARY, objects)
        headers = ("eha_plant.h", "eha_model.h", LIBRARY)
        sources = tuple(f"source/{name}" for name in (PLANT, "eha_tables.h", KERNEL))
        try:
            (folder / "source").mkdir(parents=True, exist_ok=True)
            return tuple(Path(shutil.copy(draft / Path(name).name, folder / name)) for name in (*headers, *sources))
        except OSError as error:
            raise EhaError(f"{folder}: cannot be written ({error.strerror}); choose another --out") from error
