"""Logging by name, as ROS 2 nodes do it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import rclpy.impl.rcutils_logger as _loggers
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.impl.rcutils_logger import RcutilsLogger

__all__ = ["LoggingSeverity", "RcutilsLogger", "get_logger", "initialize", "shutdown"]
_root_logger = RcutilsLogger()


def get_logger(name: str) -> RcutilsLogger:
    """Return the logger of that name.

    Raises:
        ValueError: the name is empty.
    """
    if not name:
        raise ValueError("Logger name must not be empty.")
    return _root_logger.get_child(name)


def initialize() -> None:
    """Start logging; nothing is left to do, kept for programs that call it."""


def shutdown() -> None:
    """End logging: no output is buffered here."""


def clear_config() -> None:
    """Forget every logger's level."""
    _loggers.clear_levels()


def set_logger_level(name: str, level: int, detailed_error: bool = False) -> None:
    """Set a logger's level."""
    _loggers.set_level(name, level)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return the level that counts for a logger."""
    return _loggers.effective_level(name)


def get_logger_level(name: str) -> LoggingSeverity:
    """Return the level set on exactly this logger."""
    return _loggers.get_level(name)


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """Return the severity of that name, whatever its case.

    Raises:
        RuntimeError: there is none.
    """
    try:
        return LoggingSeverity[log_severity.upper()]
    except KeyError as error:
        raise RuntimeError(f"Logging severity {log_severity!r} is unknown") from error


def get_logging_directory() -> Path:
    """Return the folder in which ROS 2 keeps log files: ROS_LOG_DIR, or log/ below ROS_HOME."""
    home = os.environ.get("ROS_HOME") or os.path.join("~", ".ros")
    return Path(os.environ.get("ROS_LOG_DIR") or os.path.join(home, "log")).expanduser()


def get_root_logger() -> Any:
    """Return the logger without a name."""
    return _root_logger
