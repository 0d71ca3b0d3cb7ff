"""A Functional Mock-up Unit: the plant for co-simulation by any tool that knows FMI."""

from __future__ import annotations

import re
import tempfile
import zipfile
from pathlib import Path

from eha_core.errors import EhaError
from eha_core.export.compiler import LINUX, WINDOWS, compile_c, require_compiler
from eha_core.export.library import KERNEL, PLANT, write_sources
from eha_core.export.model import ExportedModel
from eha_core.export.model_description import describe

PLATFORMS = {
    2: {LINUX: ("linux64", "so"), WINDOWS: ("win64", "dll")},
    3: {LINUX: ("x86_64-linux", "so"), WINDOWS: ("x86_64-windows", "dll")},
}
"""By FMI's version, the folder of each target under `binaries/`, and how its libraries end."""


def write_fmu(model: ExportedModel, path: Path, version: int = 2) -> Path:
    """Write an FMU of FMI 2.0 or 3.0 with a library for each of PLATFORMS; the same model makes the same bytes.

    Raises EhaError where ziglang is missing or the file cannot be written.
    """
    require_compiler()
    name = re.sub(r"\W", "_", path.stem, flags=re.ASCII)
    identifier = name if name[:1].isalpha() else f"eha_{name}"
    description, token = describe(model, path.stem, identifier, version)
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        source = f"fmi{version}.c"
        write_sources(model, folder, source, "fmu.h")
        files = {"modelDescription.xml": description.encode()}
        for target, (platform, ending) in PLATFORMS[version].items():
            library = f"{identifier}.{ending}"
            words = ["-shared", "-s", f'-DFMU_TOKEN="{token}"', KERNEL, PLANT, source, "-lm", "-o", library]
            compile_c(folder, target, words)
            files[f"binaries/{platform}/{library}"] = (folder / library).read_bytes()
    try:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as unit:
            for place, content in files.items():
                entry = zipfile.ZipInfo(place)  # of a fixed date
                entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o755 << 16
                unit.writestr(entry, content)
    except OSError as error:
        raise EhaError(f"{path}: cannot be written ({error.strerror}); choose another --out") from error
    return path
