"""What the verbs share: a node for the length of a command, waiting for discovery, quality of service options."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import rclpy
import rclpy.parameter
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.task import Future
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from rclpy_dds.commands.values import load_class
from rclpy_dds.errors import CommandError

HIDDEN_NODE_PREFIX = "_"
_POLL = 0.02
# What a participant that was discovered may take to tell its endpoints and nodes: Fast DDS' heartbeats come every 3 s.
_SLOWEST_DISCOVERY = 5.0


@contextmanager
def command_node(name: str | None = None, **options: Any) -> Iterator[Node]:
    """Give a node that is hidden from lists and gone when the command ends."""
    rclpy.init(args=[])
    options.setdefault("start_parameter_services", False)
    node = Node(name or f"_ros2cli_{os.getpid()}", **options)
    try:
        yield node
    except ExternalShutdownException:
        raise KeyboardInterrupt from None
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


def add_spin_time(parser: argparse.ArgumentParser) -> None:
    """Add the options about discovery."""
    parser.add_argument(
        "--spin-time", type=float, default=0.5, help="Spin time in seconds to wait for discovery (default: %(default)s)"
    )
    parser.add_argument("--no-daemon", action="store_true", help="Accepted for compatibility: there is no daemon here")
    parser.add_argument("-s", "--use-sim-time", action="store_true", help="Enable ROS simulation time")


def discover(node: Node, args: argparse.Namespace) -> None:
    """Wait until discovery has had its time."""
    wait_in_graph(node, lambda: False, args.spin_time)


def wait_until(condition: Callable[[], Any], timeout: float | None) -> Any:
    """Return the condition's value as soon as it is true, or its last value after `timeout` seconds."""
    end = None if timeout is None else time.monotonic() + timeout
    while not (value := condition()):
        if not rclpy.ok():
            raise KeyboardInterrupt
        if end is not None and time.monotonic() >= end:
            break
        time.sleep(_POLL)
    return value


def wait_in_graph(node: Node, condition: Callable[[], Any], timeout: float | None) -> Any:
    """Wait like `wait_until`, and longer while a discovered participant has still to tell what it has."""
    if value := wait_until(condition, timeout):
        return value
    wait_until(lambda: condition() or node.context.graph.settled(), _SLOWEST_DISCOVERY)
    return condition()


def spin(node: Node, until: Future | None = None, timeout: float | None = None) -> None:
    """Run a node until Ctrl-C, a future is done or the time is up."""
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        if until is None:
            executor.spin()
        else:
            executor.spin_until_future_complete(until, timeout)
    finally:
        executor.shutdown(0)


def full_node_names(node: Node, include_hidden: bool = False) -> list[str]:
    """Return the full names of the nodes in the graph, sorted."""
    found = node.get_node_names_and_namespaces()
    return sorted(
        f"{namespace.rstrip('/')}/{name}"
        for name, namespace in found
        if include_hidden or not name.startswith(HIDDEN_NODE_PREFIX)
    )


def call(node: Node, srv_type: Any, name: str, request: Any, timeout: float) -> Any:
    """Call a service and return the reply.

    Raises:
        CommandError: nobody offers it, or no reply came in time.
    """
    client = node.create_client(srv_type, name)
    try:
        if not client.wait_for_service(timeout):
            raise CommandError(
                f"service {name} is not available after {timeout:g} s: is the node running in domain {_domain()}?"
            )
        future = client.call_async(request)
        spin(node, future, max(timeout, 5.0))
        if not future.done():
            raise CommandError(f"service {name} did not answer within {max(timeout, 5.0):g} s")
        return future.result()
    finally:
        node.destroy_client(client)


def _domain() -> str:
    return os.environ.get("ROS_DOMAIN_ID", "0")


def add_qos(parser: argparse.ArgumentParser) -> None:
    """Add the --qos-* options."""
    parser.add_argument(
        "--qos-profile", choices=QoSPresetProfiles.short_keys(), help="Quality of service preset profile"
    )
    parser.add_argument("--qos-depth", metavar="N", type=int, help="Queue size setting")
    for name, policy in (
        ("history", HistoryPolicy),
        ("reliability", ReliabilityPolicy),
        ("durability", DurabilityPolicy),
        ("liveliness", LivelinessPolicy),
    ):
        parser.add_argument(f"--qos-{name}", choices=policy.short_keys(), help=f"Quality of service {name} setting")
    parser.add_argument("--qos-liveliness-lease-duration-seconds", type=float, help="Liveliness lease duration")


def chosen_qos(args: argparse.Namespace, default: QoSProfile) -> QoSProfile:
    """Return the profile the --qos-* options describe on top of a default."""
    profile = QoSPresetProfiles.get_from_short_key(args.qos_profile) if args.qos_profile else default
    values = profile.to_dict()
    for name, policy in (
        ("history", HistoryPolicy),
        ("reliability", ReliabilityPolicy),
        ("durability", DurabilityPolicy),
        ("liveliness", LivelinessPolicy),
    ):
        if text := getattr(args, f"qos_{name}"):
            values[name] = policy[text.upper()]
    if args.qos_depth is not None:
        values["depth"] = args.qos_depth
    if args.qos_liveliness_lease_duration_seconds is not None:
        values["liveliness_lease_duration"] = Duration(seconds=args.qos_liveliness_lease_duration_seconds)
    return QoSProfile(**values)


def topic_type(node: Node, topic: str, timeout: float | None) -> str | None:
    """Return the type of a topic as soon as somebody uses it, None when nobody does in time."""
    full = topic if topic.startswith("/") else f"/{topic}"

    def find() -> list[str]:
        return dict(node.get_topic_names_and_types()).get(full, [])

    types = wait_in_graph(node, find, timeout)
    if len(types) > 1:
        raise CommandError(f"Cannot echo topic '{full}', as it contains more than one type: [{', '.join(types)}]")
    return types[0] if types else None


def offered_qos(node: Node, topic: str) -> QoSProfile:
    """Return a profile that receives from every publisher there is: reliable or latched only when all are."""
    infos = node.get_publishers_info_by_topic(topic)
    reliable = bool(infos) and all(i.qos_profile.reliability == ReliabilityPolicy.RELIABLE for i in infos)
    latched = bool(infos) and all(i.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for i in infos)
    return QoSProfile(
        depth=10,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def add_watched(parser: argparse.ArgumentParser, window: int) -> None:
    """Add a topic to watch, and how many of its last messages count."""
    add_spin_time(parser)
    parser.add_argument("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')")
    parser.add_argument(
        "--window", "-w", type=int, default=window, help="window size, in # of messages (default: %(default)s)"
    )


def watch(
    args: argparse.Namespace, add: Callable[[Any, Node], None], summary: Callable[[], str], raw: bool = True
) -> None:
    """Give every message of a topic to `add`, and print what `summary` says once a second, until Ctrl-C."""
    sim_time = [rclpy.parameter.Parameter("use_sim_time", value=True)] if args.use_sim_time else []
    with command_node(parameter_overrides=sim_time) as node:
        name = topic_type(node, args.topic_name, None)
        assert name is not None
        qos = offered_qos(node, args.topic_name)
        node.create_subscription(load_class(name, "msg"), args.topic_name, lambda m: add(m, node), qos, raw=raw)
        wall = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(1.0, lambda: print(summary(), end="", flush=True), clock=wall)
        spin(node)


def add_found(parser: argparse.ArgumentParser, kind: str) -> None:
    """Add the type that topics or services are looked for by."""
    add_spin_time(parser)
    parser.add_argument(f"{kind}_type", metavar=f"{kind}_type", help=f"Name of the ROS {kind} type to filter for")
    parser.add_argument("-c", f"--count-{kind}s", dest="count", action="store_true", help="Only display the number")
    parser.add_argument(f"--include-hidden-{kind}s", dest="hidden", action="store_true", help="Consider hidden ones")


def print_found(args: argparse.Namespace, wanted: str, query: Callable[[Node], list[tuple[str, list[str]]]]) -> None:
    """Print what is of a type, or how many."""
    with command_node() as node:
        discover(node, args)
        names = [name for name, types in query(node) if wanted in types]
    shown = [name for name in names if args.hidden or not topic_or_service_is_hidden(name)]
    print(len(shown) if args.count else "\n".join(shown), end="\n" if shown or args.count else "")
