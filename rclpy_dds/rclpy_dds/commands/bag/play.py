"""Play back ROS data from a bag."""

from __future__ import annotations

import argparse
import time
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from rosgraph_msgs.msg import Clock

from rclpy_dds import bounded_yaml
from rclpy_dds.commands.bag import pattern
from rclpy_dds.commands.common import command_node
from rclpy_dds.errors import CommandError
from rclpy_dds.interfaces import store
from rclpy_dds.interfaces.message import message_class
from rclpy_dds.recordings.reading import messages, summarise


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    parser.add_argument("bag_path", help="Bag to open")
    parser.add_argument("-s", "--storage", choices=["mcap"], help="Storage implementation of the bag")
    parser.add_argument("-r", "--rate", type=float, default=1.0, help="rate at which to play back messages; > 0.0")
    parser.add_argument("--topics", nargs="+", default=[], help="topics to replay; all when not given")
    parser.add_argument("-e", "--regex", type=pattern, help="replay topics whose whole name this matches")
    parser.add_argument("-x", "--exclude-regex", type=pattern, help="replay no topic whose whole name this matches")
    parser.add_argument("--exclude-topics", nargs="+", default=[], help="topics not to replay")
    parser.add_argument("-m", "--remap", nargs="+", default=[], help="names as old_topic:=new_topic")
    parser.add_argument("-l", "--loop", action="store_true", help="start again at the end")
    parser.add_argument("--start-offset", type=float, default=0.0, help="seconds to skip at the start")
    parser.add_argument("--playback-duration", type=float, default=-1.0, help="seconds of the recording to play")
    parser.add_argument("-d", "--delay", type=float, default=0.0, help="sleep this many seconds before playing")
    parser.add_argument(
        "--clock", type=float, nargs="?", const=40.0, default=0.0, help="publish /clock at this rate in Hz"
    )
    parser.add_argument("--read-ahead-queue-size", type=int, default=1000, help="accepted for compatibility")
    parser.add_argument("--disable-keyboard-controls", action="store_true", help="accepted: there are no such controls")
    parser.add_argument("--wait-for-all-acked", type=float, default=0.0, help="ms to wait for subscriptions at the end")


def main(args: argparse.Namespace) -> str | None:
    """Play the recording."""
    if not args.rate > 0.0:
        return f"--rate {args.rate} must be greater than zero"
    summary = summarise(args.bag_path)
    if not summary.count:
        return f"{args.bag_path} holds no messages"
    remaps = {}
    for rule in args.remap:
        old, separator, new = rule.partition(":=")
        if not separator:
            return f"--remap {rule!r} must be old_topic:=new_topic"
        remaps[old] = new
    with command_node("rosbag2_player") as node:
        player = _Player(node, args, remaps, summary.start)
        while True:
            player.play()
            if not args.loop or not rclpy.ok():
                break
        player.finish()
    return None


class _Player:
    """Publishes recorded messages in their rhythm."""

    def __init__(self, node: Node, args: argparse.Namespace, remaps: dict[str, str], start: int) -> None:
        self.node = node
        self.args = args
        self.remaps = remaps
        self.first = start + int(args.start_offset * 1e9)
        self.last = self.first + int(args.playback_duration * 1e9) if args.playback_duration >= 0 else None
        self.publishers: dict[str, Any] = {}
        self.clock = node.create_publisher(Clock, "/clock", 10) if args.clock else None
        self.next_clock = 0
        self._open()
        time.sleep(args.delay)

    def _open(self) -> None:
        """Make every publisher first, so that discovery is over when the first message goes out."""
        seen = set()
        for schema, channel, _ in messages(self.args.bag_path):
            if channel.topic in seen:
                continue
            seen.add(channel.topic)
            if schema is None or channel.message_encoding != "cdr" or not self._wanted(channel.topic):
                continue
            if schema.encoding == "ros2msg":
                store.add_recorded(schema.name, schema.data.decode())
            try:
                kind = message_class(schema.name)
            except (LookupError, ValueError) as error:
                self.node.get_logger().warning(f"Ignoring topic '{channel.topic}' of type {schema.name}: {error}")
                continue
            topic = self.remaps.get(channel.topic, channel.topic)
            self.publishers[channel.topic] = self.node.create_publisher(kind, topic, _offered(channel.metadata))
        if not self.publishers:
            raise CommandError(f"{self.args.bag_path}: no topic left to play")
        topics = ", ".join(f"'{publisher.topic_name}'" for publisher in self.publishers.values())
        self.node.get_logger().info(f"Playing {topics} from '{self.args.bag_path}', press Ctrl-C to stop")
        time.sleep(0.5)

    def _wanted(self, topic: str) -> bool:
        args = self.args
        chosen = not (args.topics or args.regex)
        chosen = chosen or topic in args.topics or bool(args.regex and args.regex.fullmatch(topic))
        excluded = topic in args.exclude_topics or bool(args.exclude_regex and args.exclude_regex.fullmatch(topic))
        return chosen and not excluded and not (args.clock and topic == "/clock")

    def play(self) -> None:
        begun = self.next_clock = 0
        for _, channel, message in messages(self.args.bag_path):
            publisher = self.publishers.get(channel.topic)
            if publisher is None or message.log_time < self.first:
                continue
            if self.last is not None and message.log_time > self.last:
                break
            begun = begun or time.monotonic_ns()  # opening and skipping took time that is not the recording's
            if not self._sleep_until(begun, message.log_time):
                return
            publisher.publish(message.data)

    def _sleep_until(self, begun: int, log_time: int) -> bool:
        """Wait for a message's moment, keeping /clock going; False when interrupted."""
        while rclpy.ok():
            elapsed = time.monotonic_ns() - begun
            recorded = self.first + int(elapsed * self.args.rate)
            if self.clock is not None and elapsed >= self.next_clock:
                self.clock.publish(Clock(clock=Time(nanoseconds=min(recorded, log_time)).to_msg()))
                self.next_clock = elapsed + int(1e9 / self.args.clock)
            remaining = (log_time - recorded) / self.args.rate / 1e9
            if remaining <= 0:
                return True
            limit = (self.next_clock - elapsed) / 1e9 if self.clock is not None else 0.1
            time.sleep(min(remaining, max(limit, 0.0), 0.1))
        return False

    def finish(self) -> None:
        from rclpy.duration import Duration

        for publisher in self.publishers.values():
            if rclpy.ok() and publisher.qos_profile.reliability == ReliabilityPolicy.RELIABLE:
                publisher.wait_for_all_acked(Duration(seconds=max(0.5, self.args.wait_for_all_acked / 1e3)))


def _offered(metadata: dict[str, str]) -> QoSProfile:
    """Return a profile that serves every subscription the recorded publishers served."""
    try:
        profiles = bounded_yaml.load(metadata.get("offered_qos_profiles", "")) or []
        reliable = all(str(p.get("reliability")) in ("reliable", "1", "system_default", "0") for p in profiles)
        latched = bool(profiles) and all(str(p.get("durability")) in ("transient_local", "1") for p in profiles)
        depth = max([10, *(int(p.get("depth") or 0) for p in profiles)])
    except (AttributeError, TypeError, ValueError):
        return QoSProfile(depth=10)
    return QoSProfile(
        depth=min(depth, 1000),
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )
