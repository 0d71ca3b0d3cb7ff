"""The default context and small helpers."""

from __future__ import annotations

import threading

from ament_index_python.packages import PackageNotFoundError  # noqa: F401 - where rclpy programs import it from

from rclpy.context import Context
from rclpy.exceptions import UnknownROSArgsError
from rclpy_dds.arguments import UnknownRosArguments, parse

g_default_context: Context | None = None
g_context_lock = threading.Lock()


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the context functions use when they are given none."""
    global g_default_context
    with g_context_lock:
        if g_default_context is None:
            g_default_context = Context()
            return g_default_context
        if shutting_down:
            old, g_default_context = g_default_context, None
            return old
        return g_default_context


def remove_ros_args(args: list[str] | None = None) -> list[str]:
    """Return a command line without what stands between --ros-args and --."""
    import sys

    try:
        return parse(sys.argv if args is None else args).others
    except UnknownRosArguments as error:
        raise UnknownROSArgsError(error.args[0]) from None


def ok(*, context: Context | None = None) -> bool:
    """Tell whether a context, by default the default one, is initialised and not shut down."""
    return (context or get_default_context()).ok()


def shutdown(*, context: Context | None = None) -> None:
    """Shut a context down, by default the default one.

    Raises:
        RuntimeError: it is not initialised.
    """
    (context or get_default_context(shutting_down=True)).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut a context down if that has not been done."""
    (context or get_default_context(shutting_down=True)).try_shutdown()


def get_rmw_implementation_identifier() -> str:
    """Return the name under which this layer speaks to DDS; on the wire it is rmw_cyclonedds_cpp."""
    return "rmw_cyclonedds_cpp"


def get_available_rmw_implementations() -> set[str]:
    """Return what RMW_IMPLEMENTATION could be set to: this layer has one."""
    return {"rmw_cyclonedds_cpp"}


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Return seconds as nanoseconds; -1 for None and for what is negative, which mean to wait for ever."""
    if timeout_sec is None or timeout_sec < 0:
        return -1
    return int(float(timeout_sec) * 1e9)
