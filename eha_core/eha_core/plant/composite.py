"""Compile the step once for the whole catalogue: write its hooks, beside a copy of the step, into a cache folder.

A compiled function caches by its own file alone and would go on calling an effect as it was before an edit. So the
folder is named by a hash of every source that the composite is made of; what it holds can be read and deleted.
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import inspect
import os
import sys
import tempfile
from functools import cache
from pathlib import Path
from types import ModuleType

import numba

from eha_core.effects import effects
from eha_core.parameters import NOMINAL
from eha_core.plant import hooks

QUANTITIES = {
    "command": 1, "schedule": 2, "spool": 1, "orifice": 3, "supply": 2, "chamber": 9, "force": 4, "sensor": 4,
}
"""How many leading arguments of each hook it also returns."""

SOURCES = (
    "compiled.py", "curve.py", "parameters.py", "plant/step.py", "plant/hooks.py", "plant/composite.py", "effects/*.py",
)


def write_hooks() -> str:
    """The source of the generated hooks: each site calls its effects in order, those that are active."""
    lines = ['"""Generated from the catalogue of effects, and written anew when a source changes: do not edit."""', ""]
    lines += ["from eha_core.compiled import inlined", ""]
    lines += [f"from eha_core.effects.{effect.id} import contribution as {effect.id}" for effect in effects()]
    place, slot = len(NOMINAL), 0
    calls: dict[str, list[str]] = {site: [] for site in QUANTITIES}
    for index, effect in enumerate(effects()):
        head = list(inspect.signature(getattr(hooks, effect.site)).parameters)
        kept = head[: QUANTITIES[effect.site]]
        arguments = [name if name != "memory" else f"memory, {slot}" for name in head[:-2]]
        arguments += [f"parameters[{place + offset}]" for offset in range(len(effect.parameters))]
        calls[effect.site].append(f"    if active[{index}]:")
        calls[effect.site].append(f"        {', '.join(kept)} = {effect.id}({', '.join(arguments)})")
        place += len(effect.parameters)
        slot += len(effect.memory)
    for site, body in calls.items():
        head = list(inspect.signature(getattr(hooks, site)).parameters)
        lines += ["", "", "@inlined", f"def {site}({', '.join(head)}):", *body]
        lines += [f"    return {', '.join(head[: QUANTITIES[site]])}"]
    return "\n".join(lines) + "\n"


def _fingerprint() -> str:
    package = Path(__file__).parent.parent
    digest = hashlib.sha256(f"{numba.__version__} {sys.version} {package}".encode())
    for pattern in SOURCES:
        for path in sorted(package.glob(pattern)):
            digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_root() -> Path:
    named = os.environ.get("EHA_CACHE_DIR")
    if named:
        return Path(named)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "eha_core"


def _write_package(folder: Path) -> None:
    """Write the package whole or not at all: several processes may start at once."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(dir=folder.parent))
    (draft / "__init__.py").write_text("", encoding="utf-8")
    (draft / "hooks.py").write_text(write_hooks(), encoding="utf-8")
    (draft / "step.py").write_text((Path(__file__).parent / "step.py").read_text(encoding="utf-8"), encoding="utf-8")
    try:
        draft.rename(folder)
    except OSError:
        if not folder.is_dir():
            raise


@cache
def compiled_step() -> ModuleType:
    """The step with every effect of the catalogue plugged in: a module with the functions of `eha_core.plant.step`."""
    name = f"eha_composite_{_fingerprint()}"
    folder = _cache_root() / name
    try:
        if not folder.is_dir():
            _write_package(folder)
    except OSError:
        folder = Path(tempfile.mkdtemp()) / name
        _write_package(folder)
    specification = importlib.util.spec_from_file_location(
        name, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    assert specification and specification.loader, "a folder that is there has a loader"
    package = importlib.util.module_from_spec(specification)
    sys.modules[name] = package
    specification.loader.exec_module(package)
    return importlib.import_module(f"{name}.step")
