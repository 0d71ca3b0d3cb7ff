"""Starts a node as a command: one clear line and exit status 2 for what a user can put right, and a clean end."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable

import rclpy
from rcl_interfaces.srv import GetParameterTypes
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future

from eha_core.errors import EhaError

_DISCOVERY = 1.5  # s until a node that is there has surely been seen, on a busy machine too
_ANSWER = 5.0  # s within which a node that lives answers
_AGAIN = 0.5  # s until it is asked once more


class StartError(EhaError):
    """The node cannot start."""


def run(make_node: Callable[[], Node], name: str) -> int:
    """Run a node until a signal ends it and return the exit status."""
    node = None
    try:
        _join()
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
    return 0


def _join() -> None:
    try:
        rclpy.init()
    except Exception as error:  # the middleware's own errors have no common base; all are about the arguments given
        raise StartError(str(error)) from error


def _refuse_namesake(node: Node) -> None:
    """Raise StartError if a living node has this one's full name.

    A node that was killed stays in the graph for a while. It does not answer, and must not keep its successor out.
    """
    name = node.get_fully_qualified_name()
    deadline = time.monotonic() + _DISCOVERY
    while _count(node, name) < 2:
        if time.monotonic() > deadline:
            return
        time.sleep(0.05)
    # Asked from a node of its own: this node's parameter services stay silent as long as nobody spins it.
    probe = Node("eha_start_probe", use_global_arguments=False, start_parameter_services=False, enable_rosout=False)
    try:
        client = probe.create_client(GetParameterTypes, f"{name}/get_parameter_types")
        asked: list[Future] = []
        deadline = time.monotonic() + _ANSWER
        while not any(future.done() for future in asked):
            if time.monotonic() > deadline:
                return
            # Again and again: a request gets lost as long as the name has been discovered, but not yet the service.
            asked.append(client.call_async(GetParameterTypes.Request(names=["use_sim_time"])))
            rclpy.spin_until_future_complete(probe, asked[-1], timeout_sec=_AGAIN)
        raise StartError(
            f"a node named {name} is running already; stop it, or start this one with --ros-args -r __node:=OTHER_NAME"
        )
    finally:
        probe.destroy_node()


def _count(node: Node, name: str) -> int:
    seen = node.get_node_names_and_namespaces()
    return sum(1 for base, namespace in seen if f"{namespace.rstrip('/')}/{base}" == name)
