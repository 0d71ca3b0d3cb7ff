"""Report the system, the settings and the topics, and endpoints whose QoS do not match."""

from __future__ import annotations

import argparse
import os
import platform
from importlib.metadata import version

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSCompatibility, qos_check_compatible

from rclpy_dds.commands.common import add_spin_time, command_node, discover

_SETTINGS = ("ROS_", "RMW_", "CYCLONEDDS_", "AMENT_PREFIX_PATH")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this command's options."""
    add_spin_time(parser)
    parser.add_argument("-r", "--report", action="store_true", help="Accepted for compatibility: it is printed anyway")


def main(args: argparse.Namespace) -> None:
    """Print the report."""
    _section("PLATFORM INFORMATION", {"system": platform.platform(), "python": platform.python_version()})
    _section("RMW MIDDLEWARE", {
        "middleware name": rclpy.get_rmw_implementation_identifier(),
        **{package: version(package) for package in ("rclpy_dds", "cyclonedds")},
    })  # fmt: skip
    _section("ENVIRONMENT", {name: os.environ[name] for name in sorted(os.environ) if name.startswith(_SETTINGS)})
    with command_node() as node:
        discover(node, args)
        topics = [name for name, _ in node.get_topic_names_and_types()]
        found = {name: (node.count_publishers(name), node.count_subscribers(name)) for name in topics}
        _section("TOPIC LIST", {
            name: f"{publishers} publishers, {subscribers} subscribers"
            for name, (publishers, subscribers) in found.items()
        })  # fmt: skip
        mismatches = {name: _mismatches(node, name) for name in topics}
        _section("QOS COMPATIBILITY LIST", {name: text for name, text in mismatches.items() if text})


def _mismatches(node: Node, topic: str) -> str:
    """What keeps a topic's publishers and subscriptions apart; empty where nothing does."""
    subscriptions = node.get_subscriptions_info_by_topic(topic)
    found = []
    for publisher in node.get_publishers_info_by_topic(topic):
        for subscription in subscriptions:
            verdict, reason = qos_check_compatible(publisher.qos_profile, subscription.qos_profile)
            if verdict == QoSCompatibility.ERROR:
                found.append(f"{publisher.node_name} to {subscription.node_name}: {reason}")
    return "; ".join(found)


def _section(title: str, rows: dict[str, str]) -> None:
    print(f"\n   {title}")
    for name, text in rows.items() or [("-", "none")]:
        print(f"{name:40}: {text}")
