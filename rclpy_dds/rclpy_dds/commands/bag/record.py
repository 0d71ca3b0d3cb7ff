"""Record ROS data to a bag."""

from __future__ import annotations

import argparse
import time
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from rclpy_dds.commands.bag import pattern
from rclpy_dds.commands.common import command_node, offered_qos
from rclpy_dds.interfaces.message import interface_class
from rclpy_dds.recordings.writing import RecordingWriter


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    parser.add_argument("topic_names", nargs="*", help="Space-delimited list of topics to record")
    parser.add_argument("--topics", nargs="+", default=[], help="Space-delimited list of topics to record")
    parser.add_argument("-a", "--all", "--all-topics", dest="all", action="store_true", help="Record all topics")
    parser.add_argument("-e", "--regex", type=pattern, help="Record topics in whose name this is found")
    parser.add_argument("--exclude-regex", type=pattern, help="Leave out topics in whose name this is found")
    parser.add_argument("--exclude-topics", nargs="+", default=[], help="Space-delimited list of topics to leave out")
    parser.add_argument("--include-hidden-topics", action="store_true", help="Record hidden topics as well")
    parser.add_argument("-o", "--output", help="Folder of the bag (default: rosbag2_<date and time>)")
    parser.add_argument("-s", "--storage", choices=["mcap"], default="mcap", help="Storage (default: mcap)")
    parser.add_argument("--no-discovery", action="store_true", help="Record only topics that are there at the start")
    parser.add_argument("-p", "--polling-interval", type=int, default=100, help="ms between looks for new topics")
    parser.add_argument("--node-name", default="rosbag2_recorder", help="Name of the recorder's node")


def main(args: argparse.Namespace) -> str | None:
    """Record until Ctrl-C."""
    names = [*args.topic_names, *args.topics]
    if not (args.all or args.regex or names):
        return "Need to specify at least one option out of --all, --topics or --regex"
    folder = args.output or time.strftime("rosbag2_%Y_%m_%d-%H_%M_%S")
    try:
        writer = RecordingWriter(folder)
    except FileExistsError:
        return f"Output folder '{folder}' already exists; choose another with -o"
    except OSError as error:
        return f"Cannot write to '{folder}': {error.strerror}"
    problem: OSError | None = None
    recorder: _Recorder | None = None  # Ctrl-C may come before there is one
    try:
        with command_node(args.node_name) as node:
            recorder = _Recorder(node, args, {name if name.startswith("/") else f"/{name}" for name in names}, writer)
            node.get_logger().info(f"Recording to '{folder}', press Ctrl-C to stop")
            while rclpy.ok():
                rclpy.spin_once(node)
                if recorder.problem is not None:
                    break
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        try:
            writer.close()
        except OSError as error:
            problem = error
    if recorder is not None:
        problem = recorder.problem or problem
    if problem is not None:
        return f"Cannot write to '{folder}': {problem.strerror}; {writer.count} messages were recorded"
    print(f"Recorded {writer.count} messages to '{folder}'")
    return None


class _Recorder:
    """Subscribes to what is wanted as it appears and writes what comes."""

    def __init__(self, node: Node, args: argparse.Namespace, names: set[str], writer: RecordingWriter) -> None:
        self.node = node
        self.args = args
        self.names = names
        self.writer = writer
        self.known: set[str] = set()
        self.problem: OSError | None = None
        self._look()
        if not args.no_discovery:
            node.create_timer(args.polling_interval / 1e3, self._look)

    def _look(self) -> None:
        for topic, types in self.node.get_topic_names_and_types():
            if topic in self.known or not self._wanted(topic):
                continue
            infos = self.node.get_publishers_info_by_topic(topic)
            if not infos:
                continue  # nobody publishes yet, so the quality of service is not known
            self.known.add(topic)
            try:
                kind = interface_class(types[0])
            except (LookupError, ValueError) as error:
                self.node.get_logger().warning(f"Topic '{topic}' is not recorded: {error}")
                continue
            self.writer.add_topic(topic, types[0], [info.qos_profile for info in infos])
            qos = offered_qos(self.node, topic)
            qos.depth = 1000
            self.node.create_subscription(kind, topic, self._writing(topic), qos, raw=True)
            self.node.get_logger().info(f"Subscribed to topic '{topic}'")

    def _wanted(self, topic: str) -> bool:
        if topic_or_service_is_hidden(topic) and not self.args.include_hidden_topics and topic not in self.names:
            return False
        if topic in self.args.exclude_topics:
            return False
        if self.args.exclude_regex and self.args.exclude_regex.search(topic):
            return False
        return bool(self.args.all or topic in self.names or (self.args.regex and self.args.regex.search(topic)))

    def _writing(self, topic: str) -> Any:
        def write(data: bytes, info: dict[str, Any]) -> None:
            if self.problem is not None:
                return
            try:
                self.writer.write(topic, data, info["received_timestamp"], info["source_timestamp"])
            except OSError as error:
                self.problem = error

        return write
