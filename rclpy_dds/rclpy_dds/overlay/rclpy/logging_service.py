"""Services through which other nodes read and set logger levels."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import LoggerLevel, SetLoggerLevelsResult
from rcl_interfaces.srv import GetLoggerLevels, SetLoggerLevels

import rclpy.impl.rcutils_logger as _loggers
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.qos import qos_profile_services_default


class LoggingService:
    """Offers get_logger_levels and set_logger_levels for a node."""

    def __init__(self, node: Any) -> None:
        for srv_type, name, callback in (
            (GetLoggerLevels, "get_logger_levels", self._get),
            (SetLoggerLevels, "set_logger_levels", self._set),
        ):
            node.create_service(
                srv_type, f"{node.get_name()}/{name}", callback, qos_profile=qos_profile_services_default
            )

    @staticmethod
    def _get(request: Any, response: Any) -> Any:
        response.levels = [LoggerLevel(name=name, level=int(_loggers.get_level(name))) for name in request.names]
        return response

    @staticmethod
    def _set(request: Any, response: Any) -> Any:
        response.results = []
        for level in request.levels:
            try:
                _loggers.set_level(level.name, LoggingSeverity(level.level))
                response.results.append(SetLoggerLevelsResult(successful=True))
            except ValueError:
                response.results.append(
                    SetLoggerLevelsResult(successful=False, reason="Failed reason: Invalid logger level.")
                )
        return response
