"""A node's log on the topic /rosout."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import Log

from rclpy.impl import rcutils_logger
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.time import Time


class RosoutPublisher(Publisher):
    """Publishes what a node logs."""

    def log(self, record: rcutils_logger.LogRecord) -> None:
        """Publish one record; after destruction or shutdown this does nothing."""
        if self._destroyed or not self._node_context.ok():
            return
        self.publish(
            Log(
                stamp=Time(nanoseconds=record.nanoseconds).to_msg(),
                level=int(record.severity),
                name=record.name,
                msg=record.message,
                file=record.file,
                function=record.function,
                line=record.line,
            )
        )


def start(node: Any, logger_name: str, profile: QoSProfile) -> RosoutPublisher:
    """Publish what a logger says from now on."""
    publisher = RosoutPublisher(node, Log, "/rosout", profile)
    rcutils_logger.sinks[logger_name] = publisher.log
    return publisher


def stop(publisher: RosoutPublisher, logger_name: str) -> None:
    """Publish no more; a later node of the same name keeps its own."""
    if rcutils_logger.sinks.get(logger_name) == publisher.log:
        del rcutils_logger.sinks[logger_name]
    publisher.destroy()
