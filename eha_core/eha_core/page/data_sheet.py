"""What a person fills in of a rig's data sheets, as its nominal file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from eha_core.errors import ParameterError
from eha_core.plant import composition_of
from eha_core.rig import asked_of, nominal_text, parameters_of, quantity


@dataclass(frozen=True)
class Sheet:
    """A nominal file's text, how many of its values are unknown, and what is wrong by line of the data sheet."""

    text: str = ""
    unknown: int = 0
    problems: Mapping[str, str] | None = None


def sheet_of(source: str, lines: Mapping[str, str]) -> Sheet:
    """The nominal file of a rig on a source from lines as they are typed; empty ones are not known.

    Raises:
        ParameterError: the lines contradict each other.
    """
    composition = composition_of({"source": source})
    given: dict[str, float] = {}
    problems: dict[str, str] = {}
    for datum in asked_of(composition):
        typed = str(lines.get(datum.name) or "").strip()
        try:
            given |= {datum.name: quantity(datum, typed)} if typed else {}
        except ParameterError as error:
            # the option's name is the command line's
            problems[datum.name] = str(error).replace(f"--{datum.name.replace('_', '-')} ", "", 1)
    if problems:
        return Sheet(problems=problems)
    entries = parameters_of(given, composition)
    return Sheet(nominal_text(entries, False, composition), sum(entry.value is None for entry in entries))
