"""Logging: format, levels, filters and /rosout."""

from __future__ import annotations

import re

import pytest
from rcl_interfaces.msg import Log
from rclpy.logging import LoggingSeverity, get_logger
from rclpy.qos import QoSProfile

from contract.conftest import Graph


def test_the_console_shows_severity_time_name_and_text(capfd: pytest.CaptureFixture[str]) -> None:
    get_logger("rig.sim").warning("pressure is low")
    assert re.search(r"\[WARN\] \[\d+\.\d{9}\] \[rig\.sim\]: pressure is low", capfd.readouterr().err)


def test_levels_are_inherited_by_name() -> None:
    parent, child = get_logger("contract_parent"), get_logger("contract_parent").get_child("child")
    parent.set_level(LoggingSeverity.ERROR)
    assert child.get_effective_level() == LoggingSeverity.ERROR
    assert not child.info("unheard") and child.error("heard")
    child.set_level(LoggingSeverity.DEBUG)
    assert child.debug("heard") and not parent.info("unheard")


def test_once_throttle_and_skip_first() -> None:
    logger = get_logger("contract_filters")
    assert [logger.info("x", once=True) for _ in range(3)] == [True, False, False]
    assert [logger.info("x", skip_first=True) for _ in range(3)] == [False, True, True]
    assert [logger.info("x", throttle_duration_sec=100.0) for _ in range(3)] == [True, False, False]
    with pytest.raises(TypeError):
        logger.info("x", unknown_option=1)


def test_messages_reach_rosout(graph: Graph) -> None:
    received: list[Log] = []
    graph.node("listener").create_subscription(Log, "/rosout", received.append, QoSProfile(depth=100))
    node = graph.node("speaker", namespace="rig")
    assert graph.spin_until(lambda: node.count_subscribers("/rosout") == 1)
    node.get_logger().error("oil is hot")
    assert graph.spin_until(lambda: any(log.msg == "oil is hot" for log in received))
    log = next(log for log in received if log.msg == "oil is hot")
    assert (log.name, log.level, log.function) == ("rig.speaker", 40, "test_messages_reach_rosout")
    assert log.line > 0 and log.file.endswith("test_logging.py")
