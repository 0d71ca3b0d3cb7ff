"""Starts a node as a command: one clear line and exit status 2 for what a user can put right, and a clean end."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable, Sequence
from random import randrange

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import UInt64

from eha_core.errors import EhaError
from eha_core.plant import Plant
from eha_sim_node.parameters import Row

_DISCOVERY = 1.5  # s until a node that is there has surely been seen, on a busy machine too
_ANSWER = 5.0  # s within which one that is in the graph says when it began, if it lives
_SHUFFLE = 1_000_000  # ns; nodes that begin within so little are put in a random order


class StartError(EhaError):
    """The node cannot start."""


def run(
    make_node: Callable[[], Node], name: str, rows: Sequence[Row] = (), prepare: Callable[[], None] | None = None
) -> int:
    """Run a node until a signal ends it and return the exit status: its `status` where it has one.

    `rows` are what `--help` tells of. `prepare` does what takes long before the node appears in the graph, where it
    would have to answer.
    """
    if {"-h", "--help"} & set(sys.argv[1:]):
        print(_help(make_node, name, rows))
        return 0
    node = None
    try:
        _join()
        _end_with_the_terminal()
        if prepare is not None:
            prepare()
        node = make_node()
        _refuse_namesake(node)
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except EhaError as error:
        print(f"{name}: {' '.join(str(error).split())}", file=sys.stderr, flush=True)
        return 2
    except Exception:
        if rclpy.ok():
            raise
        # A signal has shut rclpy down, and the call that was under way failed for it.
    finally:
        # `ros2 launch` and the terminal may both tell of a Ctrl-C; the second must not break off the end.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if node is not None:
            if hasattr(node, "close"):
                node.close()
            node.destroy_node()
        rclpy.try_shutdown()
    return int(getattr(node, "status", 0))


def compile_plant() -> None:
    """Compile the plant, which says so, or read its code from the cache; say how long that took."""
    log = get_logger("eha_plant")
    log.info("loading the plant")
    start = time.monotonic()
    Plant().advance(0.0, 1)
    log.info(f"the plant is ready after {time.monotonic() - start:.1f} s")


def _help(make_node: Callable[[], Node], name: str, rows: Sequence[Row]) -> str:
    """What the node does, its own parameters, and how they are given."""
    module = sys.modules[make_node.__module__]
    executable = make_node.__module__.rpartition(".")[2]
    if executable == "__main__":
        executable = name.removeprefix("eha_")
    usage = f"usage: ros2 run eha_sim_node {executable} [--ros-args -p NAME:=VALUE ... --params-file FILE ...]"
    width = max((len(row.name) for row in rows), default=0)
    lines = [f"  {row.name:{width}}  {row.meaning} (default {row.default!r})" for row in rows]
    more = f"`ros2 param list /{name}` names every parameter of the running node, `ros2 param describe` tells of one."
    return "\n".join([usage, "", module.__doc__ or "", "", "parameters:", *lines, "", more])


def _end_with_the_terminal() -> None:
    """Let a terminal that closes end the node as Ctrl-C does, its files finished; under nohup it runs on."""
    if signal.getsignal(signal.SIGHUP) == signal.SIG_DFL:
        signal.signal(signal.SIGHUP, lambda *_: signal.raise_signal(signal.SIGINT))


def _join() -> None:
    try:
        rclpy.init()
    except Exception as error:  # the middleware's own errors have no common base; all are about the arguments given
        raise StartError(str(error)) from error


def _refuse_namesake(node: Node) -> None:
    """Raise StartError if another node of this one's full name runs, or began to start before this one did.

    Each says on a latched topic when it began, and 0 once it runs; who hears a smaller number gives way, so that of
    several that start at once one stays. A node that was killed is in the graph for some time, but says nothing: it
    does not keep its successor out.
    """
    name = node.get_fully_qualified_name()
    latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    began = time.time_ns() // _SHUFFLE * _SHUFFLE + randrange(1, _SHUFFLE)
    claims = node.create_publisher(UInt64, "~/_began", QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    claims.publish(UInt64(data=began))
    # Heard by a node of its own: nothing of this one may act before it is clear that it stays.
    probe = Node("eha_start_probe", use_global_arguments=False, start_parameter_services=False, enable_rosout=False)
    try:
        heard: set[int] = set()
        probe.create_subscription(UInt64, f"{name}/_began", lambda message: heard.add(message.data), latched)
        start = time.monotonic()
        while _undecided(heard, began, time.monotonic() - start, lambda: _count(node, name)):
            rclpy.spin_once(probe, timeout_sec=0.05)
    finally:
        probe.destroy_node()
    if min(heard, default=began) < began:
        raise StartError(
            f"a node named {name} is running already; stop it, or start this one with --ros-args -r __node:=OTHER_NAME"
        )
    claims.publish(UInt64(data=0))


def _undecided(heard: set[int], began: int, waited: float, namesakes: Callable[[], int]) -> bool:
    """Tell whether it pays to listen on: nobody came first so far, and who is in the graph may not have been heard."""
    if min(heard, default=began) < began:
        return False
    return waited < _DISCOVERY or (waited < _ANSWER and namesakes() > max(1, len(heard)))


def _count(node: Node, name: str) -> int:
    seen = node.get_node_names_and_namespaces()
    return sum(1 for base, namespace in seen if f"{namespace.rstrip('/')}/{base}" == name)
