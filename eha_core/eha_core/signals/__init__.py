"""Signals for voltage commands and position references; a file in this folder is a signal, there is no list of them."""

from __future__ import annotations

import pkgutil
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from types import MappingProxyType

from eha_core.errors import ParameterError, remedy
from eha_core.signals.signal import Signal, SignalParameter

__all__ = ["Signal", "SignalParameter", "from_text", "make_signal", "of_reference", "signals"]


@cache
def signals() -> Mapping[str, type[Signal]]:
    """Every signal class by its name, which is that of its file."""
    modules = [import_module(f"{__name__}.{info.name}") for info in pkgutil.iter_modules(__path__)]
    found = [
        member
        for module in modules
        for member in vars(module).values()
        if getattr(member, "__module__", None) == module.__name__
        and isinstance(member, type)
        and issubclass(member, Signal)
    ]
    return MappingProxyType({signal.name: signal for signal in found if signal is not Signal})


def make_signal(name: str, parameters: Mapping[str, object] | None = None) -> Signal:
    """Make a signal by name; parameters left out take their defaults.

    Raises:
        ParameterError: unknown name or parameter, or a value out of its range.
    """
    if name not in signals():
        raise ParameterError(f"there is no signal {name!r}; {remedy(name, signals())}")
    signal = signals()[name]
    known = [row.name for row in signal.parameters()]
    for parameter in parameters or {}:
        if parameter not in known:
            what_to_do = remedy(parameter, known, f"it has {', '.join(known)}")
            raise ParameterError(f"signal {name} has no parameter {parameter!r}; {what_to_do}")
    return signal(**dict(parameters or {}))  # type: ignore[arg-type]


def of_reference(parameters: Mapping[str, object]) -> tuple[str, dict[str, object]]:
    """The name of the signal that the reference node's parameters choose, and the parameters of that signal alone."""
    name = str(parameters.get("signal"))
    start = f"{name}."
    return name, {key.removeprefix(start): value for key, value in parameters.items() if key.startswith(start)}


def from_text(text: str) -> Signal:
    """Make a signal from a command line's words, such as `sine:amplitude=8.4e-3,frequency=1`.

    Raises:
        ParameterError: as `make_signal` does, or for words that are no `name=value`.
    """
    name, _, words = text.partition(":")
    parameters: dict[str, object] = {}
    for word in filter(None, (word.strip() for word in words.split(","))):
        parameter, equals, value = word.partition("=")
        if not equals:
            raise ParameterError(f"signal {text!r}: {word!r} is no name=value; write sine:amplitude=8.4e-3,frequency=1")
        parameters[parameter.strip()] = value.strip()
    return make_signal(name.strip(), parameters)
