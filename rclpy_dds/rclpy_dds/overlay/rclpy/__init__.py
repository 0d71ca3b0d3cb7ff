"""rclpy's API on Cyclone DDS: present only where no real rclpy is."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Any

from rclpy.context import Context
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions, install_signal_handlers, uninstall_signal_handlers
from rclpy.task import Future
from rclpy.utilities import (
    get_default_context,
    get_rmw_implementation_identifier,
    ok,
)
from rclpy.utilities import shutdown as _shutdown
from rclpy.utilities import try_shutdown as _try_shutdown

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node

__all__ = [
    "Context", "Future", "InitContextManager", "Parameter", "SignalHandlerOptions", "create_node",
    "get_default_context", "get_global_executor", "get_rmw_implementation_identifier", "init", "logging", "ok",
    "shutdown", "spin", "spin_once", "spin_until_future_complete", "try_shutdown",
]  # fmt: skip
__rclpy_dds__ = True
_global_executor: Executor | None = None


class InitContextManager:
    """What init returns, so that it can stand in a with statement."""

    def __init__(
        self,
        args: list[str] | None,
        context: Context | None,
        domain_id: int | None,
        options: SignalHandlerOptions | None,
    ) -> None:
        self.installed_signal_handlers = False
        default = self._default = context is None
        context = get_default_context() if context is None else context
        if options is None:
            options = SignalHandlerOptions.ALL if default else SignalHandlerOptions.NO
        context.init(args, domain_id=domain_id)
        self.context = context
        install_signal_handlers(options)

    def __enter__(self) -> InitContextManager:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        try_shutdown(context=None if self._default else self.context)


def init(
    *,
    args: list[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> InitContextManager:
    """Join the ROS graph.

    Args:
        args: the command line, sys.argv when None.
        context: the context to initialise, the default one when None.
        domain_id: the domain, ROS_DOMAIN_ID when None.
        signal_handler_options: which signals shut rclpy down; all for the default context, else none.
    """
    return InitContextManager(args, context, domain_id, signal_handler_options)


def get_global_executor() -> Executor:
    """Return the executor that the spin functions use when they are given none."""
    global _global_executor
    executor = _global_executor
    if executor is None:
        from rclpy.executors import SingleThreadedExecutor

        executor = _global_executor = SingleThreadedExecutor()
        get_default_context().on_shutdown(_forget_global_executor)  # at once, where a signal came first
    return executor


def _forget_global_executor() -> None:
    global _global_executor
    _global_executor = None


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Leave the ROS graph.

    Raises:
        RuntimeError: rclpy is not initialised.
    """
    _shutdown(context=context)
    if uninstall_handlers or (uninstall_handlers is None and context is None):
        uninstall_signal_handlers()


def try_shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Leave the ROS graph if that has not been done."""
    _try_shutdown(context=context)
    if uninstall_handlers or (uninstall_handlers is None and context is None):
        uninstall_signal_handlers()


def create_node(node_name: str, **options: Any) -> Node:
    """Make a node; the options are those of rclpy.node.Node."""
    from rclpy.node import Node

    return Node(node_name, **options)


def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Run one callback of a node, waiting at most the time given (s)."""
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        executor.spin_once(timeout_sec=timeout_sec)
    finally:
        executor.remove_node(node)


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run a node's callbacks until rclpy is shut down.

    Raises:
        ExternalShutdownException: a signal or another thread shut it down.
    """
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        while executor.context.ok() and not executor.is_shutdown:
            executor.spin_once()
    finally:
        executor.remove_node(node)


def spin_until_future_complete(
    node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run a node's callbacks until a future is done, at most the time given (s)."""
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        executor.spin_until_future_complete(future, timeout_sec)
    finally:
        executor.remove_node(node)


from rclpy import logging  # noqa: E402 - part of the public face, after what it needs
