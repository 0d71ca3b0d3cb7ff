"""The policies of participants and endpoints that discovery tells of."""

from __future__ import annotations

import ctypes
import threading
from typing import Any

from cyclonedds.internal import dds_c_t
from cyclonedds.qos import Policy, Qos, _CQos

_lock = threading.Lock()


class _DiscoveredQos(_CQos):
    """cyclonedds's way from C to Python, for the policies ROS uses.

    cyclonedds forgets to free the user data; partitions, which it forgets too, ROS does not use.
    """

    _all_scopes: Any = ("Reliability", "Durability", "History", "Lifespan", "Deadline", "Liveliness", "Userdata")

    @classmethod
    def _get_p_userdata(cls, qos: Any) -> Any:
        value, size = ctypes.c_void_p(), ctypes.c_size_t()
        cls._get_userdata(qos, ctypes.byref(value), ctypes.byref(size))
        data = ctypes.string_at(value, size.value) if size else b""
        cls.free(value)
        return Policy.Userdata(data) if data else None


def discovered_qos(pointer: int) -> Qos:
    """Return the policies behind Cyclone DDS's pointer to them."""
    with _lock:  # cyclonedds reads the policies into variables that all threads share
        return _DiscoveredQos.cqos_to_qos(ctypes.cast(pointer, dds_c_t.qos_p))
