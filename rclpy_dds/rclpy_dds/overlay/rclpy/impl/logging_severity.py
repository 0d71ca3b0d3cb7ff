"""How grave a log message is."""

from enum import IntEnum


class LoggingSeverity(IntEnum):
    """Severities, as rcl_interfaces/msg/Log numbers them."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50
