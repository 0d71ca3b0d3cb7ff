"""`eha effects`: list the catalogue of effects, or show one."""

from __future__ import annotations

import argparse
import inspect
from importlib import import_module

from eha_core.effects import SITES, Effect, effects
from eha_core.errors import ParameterError, remedy
from eha_core.parameter import Parameter
from eha_core.parameters import acting_rows, catalogue


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb to the command line."""
    parser = subparsers.add_parser(
        "effects",
        help="list the physical effects that the simulator can add",
        description="Lists the catalogue of physical effects by where in the actuator they act, or shows one in full.",
    )
    parser.add_argument("id", nargs="?", help="show this effect: its description, equation and parameters")
    parser.add_argument("--parameters", action="store_true", help="list every parameter, the nominal plant's first")


def run(arguments: argparse.Namespace) -> int:
    """Print the catalogue, one effect, or the parameters."""
    if arguments.id:
        print(_one(_find(arguments.id)))
    elif arguments.parameters:
        print("\n".join(_row(name, row) for name, row in catalogue().items() if not _of_curve(name)))
    else:
        print(_listing())
    return 0


def _listing() -> str:
    named = [effect for effect in effects() if effect.named]
    width = max(len(effect.id) for effect in named)
    lines = []
    for site in SITES:
        lines.append(site)
        lines += [f"  {effect.id:{width}}  {_summary(effect)}" for effect in named if effect.site == site]
    lines += ["", "`eha effects ID` shows one in full; `eha effects --parameters` lists all parameters."]
    return "\n".join(lines)


def _one(effect: Effect) -> str:
    rows = {**dict(zip(effect.parameter_names(), effect.parameters, strict=True)), **acting_rows(effect)}
    lines = [f"{effect.id} ({effect.site})", "", _docstring(effect), "", effect.equation, ""]
    return "\n".join([*lines, *(_row(name, row) for name, row in rows.items())])


def _row(name: str, row: Parameter) -> str:
    range_text = f"{row.lower:g} to {row.upper:g}"
    return f"{name} [{row.unit}] = {row.nominal:g}, {range_text}: {row.meaning} ({row.source})"


def _docstring(effect: Effect) -> str:
    return inspect.getdoc(import_module(f"eha_core.effects.{effect.id}")) or ""


def _summary(effect: Effect) -> str:
    return " ".join(_docstring(effect).partition("\n\n")[0].split())


def _of_curve(name: str) -> bool:
    """Whether it is a knot of a recovered curve, which nobody sets by hand."""
    return name.partition(".")[0] in {effect.id for effect in effects() if not effect.named}


def _find(identifier: str) -> Effect:
    known = {effect.id: effect for effect in effects()}
    if identifier not in known:
        what_to_do = remedy(identifier, known, "`eha effects` lists them")
        raise ParameterError(f"there is no effect named {identifier}; {what_to_do}")
    return known[identifier]
