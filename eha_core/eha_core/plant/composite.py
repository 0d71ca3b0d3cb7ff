"""Compile the step once for the whole catalogue: write its hooks, beside a copy of the step, into a cache folder.

Under a servo valve that is one folder, with the lock-step beside it. All other sources share a second one, which is
compiled when such a plant is first asked for; there the step asks at run time which of them delivers.

A compiled function caches by its own file alone and would go on calling an effect as it was before an edit. So the
folder is named by a hash of every source that the composite is made of; what it holds can be read and deleted.
"""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import inspect
import logging
import os
import sys
import tempfile
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numba

from eha_core.effects import SITES, Effect, effects
from eha_core.parameters import NOMINAL, step_rows
from eha_core.plant import hooks, lane_hooks
from eha_core.plant.lane_rows import LANES, PARAMETERS
from eha_core.plant.parts import Source, parts

SOURCES = (
    "compiled.py",
    "curve.py",
    "decay.py",
    "parameters.py",
    "plant/vector.py",
    "plant/state.py",
    "plant/equations.py",
    "plant/scheme.py",
    "plant/step.py",
    "plant/hooks.py",
    "plant/lane_rows.py",
    "plant/lane_hooks.py",
    "plant/lanes.py",
    "plant/windows.py",
    "plant/active_intervals.py",
    "plant/composite.py",
    "plant/ring.py",
    "plant/source.py",
    "plant/given.py",
    "plant/parts/sources/*.py",
    "effects/*.py",
)


def slots_of(effect: Effect, first: int) -> range:
    """The memory slots that an effect of a site with memory is called with; without any of its own one that it leaves
    alone."""
    return range(first, first + max(1, len(effect.memory)))


def write_hooks() -> str:
    """The source of the generated hooks: each site calls its effects in order, those that are active."""
    lines = ['"""Generated from the catalogue of effects, and written anew when a source changes: do not edit."""', ""]
    lines += ["from eha_core.compiled import inlined", ""]
    lines += [f"from eha_core.effects.{effect.id} import contribution as {effect.id}" for effect in effects()]
    place, slot = len(NOMINAL), 0
    calls: dict[str, list[str]] = {site: [] for site in SITES}
    for index, effect in enumerate(effects()):
        head = list(inspect.signature(getattr(hooks, effect.site)).parameters)
        kept = head[: SITES[effect.site].quantities]
        slots = ", ".join(map(str, slots_of(effect, slot)))
        arguments = [name if name != "memory" else f"memory, {slots}" for name in head[:-2]]
        arguments += [f"parameters[{place + offset}]" for offset in range(len(effect.parameters))]
        calls[effect.site].append(f"    if active[{index}]:")
        calls[effect.site].append(f"        {', '.join(kept)} = {effect.id}({', '.join(arguments)})")
        place += len(effect.parameters)
        slot += len(effect.memory)
    for site, body in calls.items():
        head = list(inspect.signature(getattr(hooks, site)).parameters)
        lines += ["", "", "@inlined", f"def {site}({', '.join(head)}):", *body]
        lines += [f"    return {', '.join(head[: SITES[site].quantities])}"]
    return "\n".join(lines) + "\n"


@cache
def given_sources() -> tuple[Source, ...]:
    """The sources whose oil flows by something else than a voltage, in the order in which the step numbers them."""
    found = [source for source in parts("source").values() if isinstance(source, Source)]
    return tuple(source for source in found if source.valve != "coil" and not source.given)


def given_names() -> tuple[str, ...]:
    """What such a plant's vector has after the catalogue: each source's own parameters, then three that `given`
    reads."""
    own = [f"{source.id}.{row.name}" for source in given_sources() for row in source.own]
    return (*own, "line", "valve", "source")


def write_source() -> str:
    """The source of the generated `source`: as `given`, with the ports of whichever source the parameters number.

    It is called and not inlined, which keeps the time to compile in bounds.
    """
    last = len(given_sources()) - 1
    own = [name.replace(".", "_") for name in given_names()[:-3]]
    head = "opening, gain, conductance, {}pressure_a, pressure_b, supply_pressure, return_pressure"
    full = head.format("first, second, ")
    lines = ['"""Generated from the sources of oil, and written anew when one changes: do not edit."""', ""]
    lines += ["from eha_core.compiled import called, inlined"]
    lines += [
        "from eha_core.plant.given import current_of, given_at, spool_of, supply_in_force, through_line, voltage_of"
    ]
    lines += [
        f"from eha_core.plant.parts.sources.{source.id} import contribution as {source.id}"
        for source in given_sources()
    ]
    lines += ["", "", "@called", f"def delivered({', '.join(['number', full, *own])}):"]
    for number, source in enumerate(given_sources()):
        arguments = ", ".join([full, *(f"{source.id}_{row.name}" for row in source.own)])
        lines += [f"    if number == {number}.0:"] if number < last else []
        lines += [f"{'        ' if number < last else '    '}return {source.id}({arguments})"]
    places = [f"parameters[{len(step_rows()) + k}]" for k in range(len(own))]
    lines += ["", "", "@inlined", f"def ports(given, {head.format('')}, parameters):"]
    lines += [f"    return delivered({', '.join(['parameters[-1]', head.format('given[0], given[1], '), *places])})"]
    return "\n".join([*lines, *_write_feed(own, places)]) + "\n"


def _write_feed(own: list[str], places: list[str]) -> list[str]:
    """The rest of that: what the sources with a line give into it, and `fed`, which takes it through the open port."""
    head = ["line_pressure", "supply_pressure", "return_pressure"]
    lined = [(number, source) for number, source in enumerate(given_sources()) if source.line]
    lines = ["", "", "from eha_core.plant.vector import SUPPLY_PRESSURE"]
    lines += [f"from eha_core.plant.parts.sources.{source.id} import feed as {source.id}_feed" for _, source in lined]
    taken = ["number", "spool_position", "first", "second", *head, *own]
    lines += ["", "", "@called", f"def feed({', '.join(taken)}):"]
    for number, source in lined:
        arguments = ["spool_position", "first", "second", *head, *(f"{source.id}_{row.name}" for row in source.own)]
        lines += [f"    if number == {number}.0:", f"        return {source.id}_feed({', '.join(arguments)})"]
    lines += ["    return 0.0, 0.0, 0.0", "", "", "@inlined"]
    lines += ["def fed(tau, given, flows, chambers, spool_position, position, velocity, pressure_a, pressure_b,"]
    lines += ["        line_pressure, return_pressure, parameters):"]
    lines += ["    if parameters[-3] > 0.0:", "        return through_line(tau, feed("]
    passed = ["parameters[-1]", "spool_position", "given[0]", "given[1]", "line_pressure"]
    lines += [f"            {', '.join([*passed, 'parameters[SUPPLY_PRESSURE]', 'return_pressure', *places])}),"]
    lines += ["            flows, chambers, spool_position, position, velocity, pressure_a, pressure_b, line_pressure,"]
    lines += ["            parameters)", "    return flows, line_pressure"]
    return lines


SEEN = ("position", "velocity", "pressure_a", "pressure_b")


def lane_row(site: str, name: str, slots: range) -> str:
    """The row of a block, or what all lanes share, that an argument of that name of an effect with these memory slots
    means."""
    if name == "memory":
        return ", ".join(["block", *(f"MEMORY + {slot} * LANES + lane" for slot in slots)])
    if name == "history":
        return "ring_of(history, lane, step_size)"
    if name in ("newest", "step_size", "time"):
        return name
    if site == "sensor" and name in SEEN:
        name = f"seen_{name}"
    name = {("spool", "target"): "new_target", ("force", "damping"): "total_damping",
            ("orifice", "spool_position"): "oil_spool",
            ("chamber", "position"): "oil_position"}.get((site, name), name)  # fmt: skip
    return f"block[{name.upper()} + lane]"


class Layout(NamedTuple):
    """Where a block's rows begin that the catalogue decides: the effects' memory, which of them act; and its end."""

    memory: int
    acts: int
    end: int


@cache
def layout() -> Layout:
    """The block of the lock-step with every effect of the catalogue."""
    memory = PARAMETERS + len(step_rows()) * LANES
    acts = memory + sum(len(effect.memory) for effect in effects()) * LANES
    return Layout(memory, acts, acts + len(effects()) * LANES)


def write_lane_hooks() -> str:
    """The source of the lock-step's hooks: each site calls its effects in order, in those lanes in which they act."""
    lines = ['"""Generated from the catalogue of effects, and written anew when a source changes: do not edit."""', ""]
    lines += ["from eha_core.compiled import called", "from eha_core.plant.lane_rows import *"]
    lines += ["from eha_core.plant.ring import ring_of", ""]
    lines += [f"from eha_core.effects.{effect.id} import contribution as {effect.id}" for effect in effects()]
    lines += ["", f"MEMORY, ACTS = {layout().memory}, {layout().acts}"]
    place, slot = len(NOMINAL), 0
    calls: dict[str, list[str]] = {site: [] for site in SITES}
    masks = dict.fromkeys(SITES, 0)
    for index, effect in enumerate(effects()):
        head = list(inspect.signature(getattr(hooks, effect.site)).parameters)[:-2]
        arguments = [lane_row(effect.site, name, slots_of(effect, slot)) for name in head]
        kept = arguments[: SITES[effect.site].quantities]
        arguments += [f"block[PARAMETERS + {place + k} * LANES + lane]" for k in range(len(effect.parameters))]
        calls[effect.site] += [
            f"    if active & {1 << index}:",
            "        for lane in range(lanes):",
            f"            if block[ACTS + {index} * LANES + lane] > 0.0:",
            f"                {', '.join(kept)} = {effect.id}({', '.join(arguments)})",
        ]
        masks[effect.site] |= 1 << index
        place += len(effect.parameters)
        slot += len(effect.memory)
    lines += [f"{site.upper()}_EFFECTS = {mask}" for site, mask in masks.items()]
    for site, body in calls.items():
        head = list(inspect.signature(getattr(lane_hooks, site)).parameters)
        lines += ["", "", "@called", f"def {site}({', '.join(head)}):", *(body or ["    pass"])]
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


def _texts(given: bool) -> dict[str, str]:
    """What a package is made of, by file name."""
    here = Path(__file__).parent
    copies = ("step.py",) if given else ("step.py", "lanes.py", "windows.py", "source.py")
    texts = {"__init__.py": "", "hooks.py": write_hooks()}
    texts |= {name: (here / name).read_text(encoding="utf-8") for name in copies}
    return texts | ({"source.py": write_source()} if given else {"lane_hooks.py": write_lane_hooks()})


def _write_package(folder: Path, given: bool) -> None:
    """Write the package whole or not at all: several processes may start at once."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(dir=folder.parent))
    for name, text in _texts(given).items():
        (draft / name).write_text(text, encoding="utf-8")
    try:
        draft.rename(folder)
    except OSError:
        if not folder.is_dir():
            raise


@cache
def _package(given: bool) -> str:
    """The generated package's name, under which it is imported."""
    name = f"eha_composite_{_fingerprint()}{'_given' if given else ''}"
    folder = _cache_root() / name
    try:
        if not folder.is_dir():
            _write_package(folder, given)
    except OSError:
        folder = Path(tempfile.mkdtemp()) / name
        _write_package(folder, given)
    specification = importlib.util.spec_from_file_location(
        name, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    assert specification and specification.loader, "a folder that is there has a loader"
    package = importlib.util.module_from_spec(specification)
    sys.modules[name] = package
    specification.loader.exec_module(package)
    return name


@cache
def _announce() -> None:
    """A warning, so that it is seen where nobody has set up logging: a silence this long looks like a hang."""
    logging.getLogger(__name__).warning("compiling the plant, once after an installation or an update: up to a minute")


def _module(given: bool, name: str) -> ModuleType:
    """One of the generated package's modules; says so where the first call will compile it."""
    module = importlib.import_module(f"{_package(given)}.{name}")
    cached = getattr(module.advance, "stats", None)  # none where NUMBA_DISABLE_JIT leaves nothing to compile
    if cached and not any(Path(cached.cache_path).glob(f"{name}.advance-*.nbi")):
        _announce()
    return module


@cache
def compiled_step() -> ModuleType:
    """The step with every effect of the catalogue plugged in: a module with the functions of `eha_core.plant.step`."""
    return _module(False, "step")


@cache
def compiled_given_step() -> ModuleType:
    """The same step under the sources whose input is measured: its `advance`."""
    return _module(True, "step")


@cache
def compiled_windows() -> ModuleType:
    """Both of them through a record's windows: the functions of `eha_core.plant.windows`."""
    return _module(False, "windows")


@cache
def compiled_lanes() -> ModuleType:
    """The lock-step with every effect of the catalogue plugged in: the functions of `eha_core.plant.lanes`."""
    return _module(False, "lanes")
