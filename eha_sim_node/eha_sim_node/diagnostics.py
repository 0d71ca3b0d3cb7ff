"""A node's health on /diagnostics, the only messages that carry wall-clock time whatever the time mode."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from eha_sim_node.stamps import set_stamp

_STANDSTILL = 1.0  # s beyond its period that a report may be late before that is reported


@dataclass
class Report:
    """One status: `troubles` (nothing when all is well) and named values."""

    values: Mapping[str, object]
    troubles: list[str] = field(default_factory=list)


class Diagnostics:
    """Publishes a node's report at a fixed wall-clock rate [Hz]."""

    def __init__(self, node: Node, rate: float, report: Callable[[], Report]) -> None:
        self._name = node.get_fully_qualified_name()
        self._report = report
        self._longest = 1.0 / rate + _STANDSTILL
        self._published: float | None = None  # until the node spins, it stands still for good reason
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._timer = node.create_timer(1.0 / rate, self.publish, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def publish(self) -> None:
        """Publish the report now."""
        report = self._report()
        now = time.monotonic()
        stood = now - self._published if self._published is not None else 0.0
        self._published = now
        if stood > self._longest:
            report.troubles.append(f"the process stood still for {stood:.3g} s")
        status = DiagnosticStatus(name=self._name.lstrip("/"), hardware_id=self._name)
        status.level = DiagnosticStatus.WARN if report.troubles else DiagnosticStatus.OK
        status.message = "; ".join(report.troubles) or "running"
        status.values = [KeyValue(key=key, value=_text(value)) for key, value in report.values.items()]
        message = DiagnosticArray(status=[status])
        set_stamp(message.header.stamp, time.time_ns())
        self._publisher.publish(message)


def _text(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
