"""Output messages from a topic."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from rclpy.task import Future

from rclpy_dds.commands.common import add_qos, add_spin_time, chosen_qos, command_node, offered_qos, spin, topic_type
from rclpy_dds.commands.values import DEFAULT_TRUNCATE_LENGTH, load_class, to_csv, to_yaml
from rclpy_dds.errors import CommandError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')")
    parser.add_argument("message_type", nargs="?", help="Type of the ROS message (e.g. 'std_msgs/msg/String')")
    add_qos(parser)
    parser.add_argument("--csv", action="store_true", help="Output all recursive fields separated by commas")
    parser.add_argument("--field", help="Echo a selected field of a message, sub-fields with dots")
    parser.add_argument(
        "-f", "--full-length", action="store_true", help="Output all elements of arrays, bytes and strings"
    )
    parser.add_argument(
        "-l", "--truncate-length", type=int, default=DEFAULT_TRUNCATE_LENGTH, help="Length to truncate to"
    )
    parser.add_argument("--no-arr", action="store_true", help="Don't print array fields of messages")
    parser.add_argument("--no-str", action="store_true", help="Don't print string fields of messages")
    parser.add_argument("--flow-style", action="store_true", help="Print collections in the flow style")
    parser.add_argument("--no-lost-messages", action="store_true", help="Don't report when a message is lost")
    parser.add_argument("--raw", action="store_true", help="Echo the raw binary representation")
    parser.add_argument(
        "--filter", dest="filter_expr", help="Python expression over m; prints messages for which it is true"
    )
    parser.add_argument("--once", action="store_true", help="Print the first message received and then exit")
    parser.add_argument("--timeout", metavar="N", type=float, help="Stop after N seconds")
    parser.add_argument("--include-message-info", "-i", action="store_true", help="Show the associated message info")


def main(args: argparse.Namespace) -> str | None:
    """Print messages as they come."""
    with command_node() as node:
        name = args.message_type or topic_type(node, args.topic_name, max(args.spin_time, args.timeout or 1.0))
        if name is None:
            print(f"WARNING: topic [{args.topic_name}] does not appear to be published yet", file=sys.stderr)
            return "Could not determine the type for the passed topic"
        done = Future()
        printer = _Printer(args, done)
        qos = chosen_qos(args, offered_qos(node, args.topic_name))
        node.create_subscription(load_class(name, "msg"), args.topic_name, printer.show, qos, raw=args.raw)
        spin(node, done, args.timeout)
        if printer.error:
            raise CommandError(printer.error)
        if args.once and args.timeout is not None and not done.done():
            return f"no message on {args.topic_name} within {args.timeout:g} s"
    return None


class _Printer:
    """Prints one message after the other in the form asked for."""

    def __init__(self, args: argparse.Namespace, done: Future) -> None:
        self.args = args
        self.done = done
        self.error = ""
        self.filter = compile(args.filter_expr, "<expression>", "eval") if args.filter_expr else None
        self.options = {
            "truncate": None if args.full_length else args.truncate_length,
            "no_arr": args.no_arr,
            "no_str": args.no_str,
        }

    def show(self, message: Any, info: Any) -> None:
        if self.filter is not None and not self._passes(message):
            return
        value = message
        for name in self.args.field.strip(".").split(".") if self.args.field else ():
            try:
                value = getattr(value, name)
            except AttributeError:
                self.error = f"Invalid field '{self.args.field}': {type(value).__name__} has no field {name!r}"
                self.done.set_result(False)
                return
        if self.args.include_message_info and not self.args.csv:
            print(to_yaml(dict(info)), end="---\n")
        if self.args.raw:
            print(value, end="\n---\n", flush=True)
        elif self.args.csv:
            print(to_csv(value, **self.options), flush=True)
        else:
            text = to_yaml(value, flow_style=self.args.flow_style, **self.options)
            print(text.removesuffix("...\n"), end="---\n", flush=True)
        if self.args.once:
            self.done.set_result(True)

    def _passes(self, message: Any) -> bool:
        try:
            return bool(eval(self.filter, {"m": message}))  # type: ignore[arg-type]
        except Exception as error:
            self.error = f"Could not evaluate the filter {self.args.filter_expr!r}: {error}"
            self.done.set_result(False)
            return False
