"""Loggers: levels by name, filters per call site, console output in rcutils' format, and a way out to /rosout."""

from __future__ import annotations

import os
import re
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.clock import Clock
from rclpy.impl.logging_severity import LoggingSeverity

_OWN_FILES = {
    os.path.realpath(__file__),
    os.path.join(os.path.dirname(os.path.dirname(os.path.realpath(__file__))), "logging.py"),
}
_COLOURS = {10: "\033[32m", 20: "\033[0m", 30: "\033[33m", 40: "\033[31m", 50: "\033[31m"}
_DEFAULT_FORMAT = "[{severity}] [{time}] [{name}]: {message}"
_ESCAPES = {"\\n": "\n", "\\t": "\t", "\\a": "\a", "\\r": "\r"}

_levels: dict[str, LoggingSeverity] = {"": LoggingSeverity.INFO}
_lock = threading.Lock()
console_enabled = True
sinks: dict[str, Callable[[LogRecord], None]] = {}
"""Publishers of /rosout by logger name; a child logger uses its nearest parent's."""


@dataclass(frozen=True)
class LogRecord:
    """One message that passed level and filters."""

    severity: LoggingSeverity
    name: str
    message: str
    function: str
    file: str
    line: int
    nanoseconds: int


def set_level(name: str, level: int) -> None:
    """Set a logger's level; UNSET takes it from its parent again."""
    _levels[name] = LoggingSeverity(level)


def get_level(name: str) -> LoggingSeverity:
    """Return the level set on exactly this logger, UNSET when there is none."""
    return _levels.get(name, LoggingSeverity.UNSET)


def effective_level(name: str) -> LoggingSeverity:
    """Return the level that counts for a logger: its own or its nearest parent's."""
    while name:
        level = _levels.get(name, LoggingSeverity.UNSET)
        if level is not LoggingSeverity.UNSET:
            return level
        name = name.rpartition(".")[0]
    return _levels[""]


def clear_levels() -> None:
    """Forget every level."""
    _levels.clear()
    _levels[""] = LoggingSeverity.INFO


def format_record(record: LogRecord, template: str | None = None) -> str:
    """Return a record as RCUTILS_CONSOLE_OUTPUT_FORMAT wants it."""
    text = template if template is not None else os.environ.get("RCUTILS_CONSOLE_OUTPUT_FORMAT", _DEFAULT_FORMAT)
    for escape, character in _ESCAPES.items():
        text = text.replace(escape, character)
    seconds, nanoseconds = divmod(record.nanoseconds, 10**9)
    local = time.localtime(seconds)
    values = {
        "severity": record.severity.name,
        "name": record.name,
        "message": record.message,
        "function_name": record.function,
        "file_name": record.file,
        "line_number": str(record.line),
        "time": f"{seconds}.{nanoseconds:09d}",
        "time_as_nanoseconds": str(record.nanoseconds),
        "date_time_with_ms": time.strftime("%Y-%m-%d %H:%M:%S", local) + f".{nanoseconds // 10**6:03d}",
    }
    return re.sub(r"\{(\w+)\}", lambda match: values.get(match[1], match[0]), text)


def emit(record: LogRecord) -> None:
    """Print a record and hand it to /rosout."""
    if console_enabled:
        _print(record)
    name = record.name
    while name:
        if sink := sinks.get(name):
            sink(record)
            return
        name = name.rpartition(".")[0]


def _print(record: LogRecord) -> None:
    stream = sys.stdout if os.environ.get("RCUTILS_LOGGING_USE_STDOUT") == "1" else sys.stderr
    text = format_record(record)
    colour = os.environ.get("RCUTILS_COLORIZED_OUTPUT")
    if colour == "1" or (colour != "0" and stream is not None and stream.isatty()):
        text = f"{_COLOURS[record.severity]}{text}\033[0m"
    if stream is not None:
        try:
            stream.write(f"{text}\n")
            stream.flush()
        except (OSError, ValueError):
            pass  # nobody reads any more; a node does not end for that


class Throttle:
    """Lets a message through at most once per period."""

    params: dict[str, Any] = {"throttle_duration_sec": None, "throttle_time_source_type": Clock()}

    @staticmethod
    def start(context: dict[str, Any]) -> None:
        context["throttle_last_logged"] = 0
        if not isinstance(context["throttle_time_source_type"], Clock):
            raise ValueError(
                "Received throttle_time_source_type of "
                f'"{context["throttle_time_source_type"]}" is not a clock instance'
            )

    @staticmethod
    def passes(context: dict[str, Any]) -> bool:
        now = context["throttle_time_source_type"].now().nanoseconds
        if now < context["throttle_last_logged"] + context["throttle_duration_sec"] * 1e9:
            return False
        context["throttle_last_logged"] = now
        return True


class SkipFirst:
    """Drops the first message."""

    params: dict[str, Any] = {"skip_first": None}

    @staticmethod
    def start(context: dict[str, Any]) -> None:
        context["first_has_been_skipped"] = False

    @staticmethod
    def passes(context: dict[str, Any]) -> bool:
        passed, context["first_has_been_skipped"] = context["first_has_been_skipped"], True
        return passed


class Once:
    """Lets only the first message through."""

    params: dict[str, Any] = {"once": None}

    @staticmethod
    def start(context: dict[str, Any]) -> None:
        context["has_been_logged_once"] = False

    @staticmethod
    def passes(context: dict[str, Any]) -> bool:
        logged, context["has_been_logged_once"] = context["has_been_logged_once"], True
        return not logged


supported_filters: dict[str, Any] = {"throttle": Throttle, "skip_first": SkipFirst, "once": Once}


def get_filters_from_kwargs(**kwargs: Any) -> list[str]:
    """Return the filters that keyword arguments ask for, in the order they apply.

    Raises:
        TypeError: an argument belongs to no filter, or a filter lacks one it needs.
    """
    known = [param for kind in supported_filters.values() for param in kind.params]
    detected = [name for name, kind in supported_filters.items() if any(kwargs.get(param) for param in kind.params)]
    for name in detected:
        for param, default in supported_filters[name].params.items():
            if kwargs.get(param) is None and default is None:
                raise TypeError(
                    f'required parameter "{param}" not specified but is required for the the logging filter "{name}"'
                )
    for param in kwargs:
        if param not in known:
            raise TypeError(f'parameter "{param}" is not one of the recognized logging options "{known}"')
    return detected


class RcutilsLogger:
    """A named logger; names with dots inherit the level of what stands before the dot."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self.contexts: dict[Any, dict[str, Any]] = {}

    def get_child(self, name: str) -> RcutilsLogger:
        """Return the logger `<this name>.<name>`."""
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return RcutilsLogger(f"{self.name}.{name}" if self.name else name)

    def set_level(self, level: int) -> None:
        """Set the least severity this logger lets through."""
        set_level(self.name, LoggingSeverity(level))

    def get_effective_level(self) -> LoggingSeverity:
        """Return the severity from which this logger lets messages through."""
        return effective_level(self.name)

    def is_enabled_for(self, severity: int) -> bool:
        """Tell whether a message of that severity passes."""
        return LoggingSeverity(severity) >= effective_level(self.name)

    def log(self, message: str, severity: int, **kwargs: Any) -> bool:
        """Log a message.

        Args:
            message: the text.
            severity: its LoggingSeverity.
            kwargs: name, throttle_duration_sec, throttle_time_source_type, skip_first, once.

        Returns:
            False when level or a filter kept it back.

        Raises:
            TypeError: an unknown option. ValueError: severity, name or filters changed between calls from one place.
        """
        severity = LoggingSeverity(severity)
        if severity < effective_level(self.name):
            return False
        name = kwargs.pop("name", self.name)
        frame = sys._getframe(1)
        while frame.f_back is not None and os.path.realpath(frame.f_code.co_filename) in _OWN_FILES:
            frame = frame.f_back
        code = frame.f_code
        context = self._context((code, frame.f_lasti), name, severity, get_filters_from_kwargs(**kwargs), kwargs)
        if not all(supported_filters[kind].passes(context) for kind in context["filters"]):
            return False
        with _lock:
            emit(
                LogRecord(severity, name, str(message), code.co_name, code.co_filename, frame.f_lineno, time.time_ns())
            )
        return True

    def _context(
        self, caller: Any, name: str, severity: LoggingSeverity, filters: list[str], options: dict[str, Any]
    ) -> dict[str, Any]:
        params = {p: options.get(p, default) for f in filters for p, default in supported_filters[f].params.items()}
        context = self.contexts.get(caller)
        if context is None:
            context = {"name": name, "severity": severity, "filters": filters, **params}
            for kind in filters:
                supported_filters[kind].start(context)
            self.contexts[caller] = context
            return context
        if severity != context["severity"]:
            raise ValueError("Logger severity cannot be changed between calls.")
        if name != context["name"]:
            raise ValueError("Logger name cannot be changed between calls.")
        if filters != context["filters"]:
            raise ValueError("Requested logging filters cannot be changed between calls.")
        if any(context[param] != value for param, value in params.items()):
            raise ValueError("Logging filter parameters cannot be changed between calls.")
        return context

    def debug(self, message: str, **kwargs: Any) -> bool:
        """Log with severity DEBUG."""
        return self.log(message, LoggingSeverity.DEBUG, **kwargs)

    def info(self, message: str, **kwargs: Any) -> bool:
        """Log with severity INFO."""
        return self.log(message, LoggingSeverity.INFO, **kwargs)

    def warning(self, message: str, **kwargs: Any) -> bool:
        """Log with severity WARN."""
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    warn = warning

    def error(self, message: str, **kwargs: Any) -> bool:
        """Log with severity ERROR."""
        return self.log(message, LoggingSeverity.ERROR, **kwargs)

    def fatal(self, message: str, **kwargs: Any) -> bool:
        """Log with severity FATAL."""
        return self.log(message, LoggingSeverity.FATAL, **kwargs)
