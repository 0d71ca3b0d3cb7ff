"""Publish a message to a topic."""

from __future__ import annotations

import argparse
import sys
import time

from rclpy.qos import QoSProfile

from rclpy_dds.commands.common import add_qos, add_spin_time, chosen_qos, command_node, spin, wait_until
from rclpy_dds.commands.values import fill, load_class, load_values


def _positive(text: str) -> float:
    value = float(text)
    if not value > 0.0:
        raise argparse.ArgumentTypeError(f"{text!r} must be positive")
    return value


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("topic_name", help="Name of the ROS topic to publish to (e.g. '/chatter')")
    parser.add_argument("message_type", help="Type of the ROS message (e.g. 'std_msgs/String')")
    parser.add_argument("values", nargs="?", default="{}", help="Values to fill the message with in YAML format")
    parser.add_argument("--stdin", action="store_true", help="Read values from standard input")
    parser.add_argument(
        "-r", "--rate", metavar="N", type=_positive, default=1.0, help="Publishing rate in Hz (default: 1)"
    )
    parser.add_argument(
        "-p", "--print", metavar="N", type=int, default=1, help="Only print every N-th published message"
    )
    times = parser.add_mutually_exclusive_group()
    times.add_argument("-1", "--once", action="store_true", help="Publish one message and exit")
    times.add_argument("-t", "--times", type=int, default=0, help="Publish this number of times and then exit")
    parser.add_argument("-w", "--wait-matching-subscriptions", type=int, help="Wait for this many subscriptions first")
    parser.add_argument("--max-wait-time-secs", type=float, help="Give up waiting for subscriptions after this time")
    parser.add_argument(
        "--keep-alive", metavar="N", type=float, default=0.1, help="Stay N seconds after the last message"
    )
    parser.add_argument("-n", "--node-name", help="Name of the created publishing node")
    add_qos(parser)


def main(args: argparse.Namespace) -> str | None:
    """Publish until the wanted number is reached or Ctrl-C."""
    msg_type = load_class(args.message_type, "msg")
    values = load_values(sys.stdin.read() if args.stdin else args.values)
    message = fill(msg_type(), values)
    count = 1 if args.once else args.times
    wanted = args.wait_matching_subscriptions
    if wanted is None:
        wanted = 1 if count else 0
    with command_node(args.node_name) as node:
        publisher = node.create_publisher(msg_type, args.topic_name, chosen_qos(args, QoSProfile(depth=10)))
        if publisher.get_subscription_count() < wanted:
            print(f"Waiting for at least {wanted} matching subscription(s)...", flush=True)
            if not wait_until(lambda: publisher.get_subscription_count() >= wanted, args.max_wait_time_secs):
                return (
                    f"Timed out waiting for subscribers: Expected {wanted} subscribers but only got "
                    f"{publisher.get_subscription_count()} subscribers"
                )
        print("publisher: beginning loop", flush=True)
        published = 0

        def publish() -> None:
            nonlocal published
            published += 1
            if args.print and published % args.print == 0:
                print(f"publishing #{published}: {message!r}\n", flush=True)
            publisher.publish(fill(message, values))

        if count == 1:
            publish()
        elif count:
            timer = node.create_timer(1.0 / args.rate, publish)
            while published < count:
                _spin_once(node)
            timer.cancel()
        else:
            node.create_timer(1.0 / args.rate, publish)
            spin(node)
        time.sleep(args.keep_alive)
    return None


def _spin_once(node: object) -> None:
    import rclpy

    rclpy.spin_once(node)
