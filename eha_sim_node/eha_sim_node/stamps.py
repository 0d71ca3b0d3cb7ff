"""Times as ROS messages carry them."""

from __future__ import annotations

from typing import Any

from eha_core.realtime import NANOSECONDS


def set_stamp(stamp: Any, nanoseconds: int) -> None:
    """Write a time [ns] into a builtin_interfaces/msg/Time."""
    stamp.sec, stamp.nanosec = divmod(nanoseconds, NANOSECONDS)


def nanoseconds_of(stamp: Any) -> int:
    """Return a builtin_interfaces/msg/Time in ns."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)
