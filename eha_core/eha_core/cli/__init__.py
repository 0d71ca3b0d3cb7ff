# PYTHON_ARGCOMPLETE_OK
"""The command line `eha`: one verb, one file in this folder, no list of them.

A verb's module offers `add_parser(subparsers)`, which adds the verb under the module's name, with a dash where that has
an underscore, and `run(arguments) -> int`, which returns the exit status.
"""

from __future__ import annotations

import argparse
import ast
import logging
import os
import pkgutil
import sys
from collections.abc import Sequence
from importlib import import_module, resources
from typing import NoReturn

from eha_core.errors import EhaError, remedy
from eha_core.version import __version__

UNUSABLE = 2
"""Exit status where the input or the arguments cannot be used."""

CLEAR_LINE = "\r\x1b[K"
"""Terminal codes that clear the current line."""

_INTERRUPTED = 130
_UNREAD = 141  # a shell's exit status of a program that SIGPIPE ended


class _Parser(argparse.ArgumentParser):
    """Reports wrong arguments in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(UNUSABLE, f"{self.prog}: {message}; see `{self.prog} --help`\n")


def verbs() -> list[str]:
    """The verbs, which are the modules of this package."""
    modules = (module.name for module in pkgutil.iter_modules(__path__))
    return sorted(name.replace("_", "-") for name in modules if not name.startswith("_"))


def _module(verb: str) -> str:
    return verb.replace("-", "_")


def _list_verbs(parser: argparse.ArgumentParser, known: Sequence[str]) -> None:
    """Add each verb with the first sentence of its module, which is read but not imported, to save time."""
    subparsers = parser.add_subparsers(dest="verb", metavar="VERB")
    for verb in known:
        source = resources.files(__name__).joinpath(f"{_module(verb)}.py").read_text(encoding="utf-8")
        sentence = (ast.get_docstring(ast.parse(source)) or "").partition(": ")[2]
        subparsers.add_parser(verb, help=" ".join(sentence.partition(".")[0].split()))


def main(words: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status; `words` defaults to those of the process."""
    words = sys.argv[1:] if words is None else words
    known = verbs()
    description = "Simulates an electro-hydraulic actuator, and finds from recordings which physics a model is missing."
    parser = _Parser(prog="eha", description=description)
    parser.add_argument("--version", action="version", version=f"eha {__version__}")
    completing = "_ARGCOMPLETE" in os.environ
    if not completing and (not words or not (words[0].startswith("-") or words[0] in known)):
        choice = f"choose {', '.join(known)}"
        parser.error(f"{words[0]!r} is not a verb; {remedy(words[0], known, choice)}" if words else choice)
    if words and words[0].startswith("-") and not completing:
        _list_verbs(parser, known)
        parser.parse_args(words)
        parser.error(f"{words[0]!r} is not a verb; choose {', '.join(known)}")
    # A verb that is named is the only one imported: others may load compilers and plotting.
    typed = os.environ.get("COMP_LINE", "").split()[1:2] if completing else words[:1]
    wanted = typed if typed and typed[0] in known else known
    subparsers = parser.add_subparsers(dest="verb", metavar="VERB", required=True)
    modules = {verb: import_module(f"{__name__}.{_module(verb)}") for verb in wanted}
    for module in modules.values():
        module.add_parser(subparsers)
    if completing:
        from argcomplete import autocomplete

        autocomplete(parser)
    arguments = parser.parse_args(words)
    # clear a progress line on the terminal first
    logging.basicConfig(format=f"{CLEAR_LINE if sys.stderr.isatty() else ''}eha {arguments.verb}: %(message)s")
    try:
        status: int = modules[arguments.verb].run(arguments)
        sys.stdout.flush()
    except EhaError as error:
        print(f"eha {arguments.verb}: {error}", file=sys.stderr)
        return UNUSABLE
    except KeyboardInterrupt:
        print(f"eha {arguments.verb}: interrupted", file=sys.stderr)
        return _INTERRUPTED
    except BrokenPipeError:
        # The reader, such as `head`, has closed the pipe; flushing the buffer must not fail again when Python ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _UNREAD
    return status
