"""What makes a class usable as a message or service type."""

from __future__ import annotations

from typing import Any

from rclpy.exceptions import NoTypeSupportImportedException
from rclpy_dds.interfaces.message import Message, Service


def check_for_type_support(msg_or_srv_type: Any) -> None:
    """Accept a message or service class.

    Raises:
        AttributeError: it is something else. NoTypeSupportImportedException: its type support is missing.
    """
    kind = type(msg_or_srv_type)
    if not hasattr(kind, "_TYPE_SUPPORT"):
        name = getattr(msg_or_srv_type, "__name__", repr(msg_or_srv_type))
        raise AttributeError(
            f"{name} is no message or service class: {kind.__name__!r} has no attribute '_TYPE_SUPPORT'"
        )
    if kind._TYPE_SUPPORT is None:
        raise NoTypeSupportImportedException()


def check_is_valid_msg_type(msg_type: Any) -> None:
    """Accept a message class.

    Raises:
        What check_for_type_support raises, and RuntimeError for a service.
    """
    check_for_type_support(msg_type)
    if not issubclass(msg_type, Message):
        raise RuntimeError(f"The message type provided is not valid ({msg_type}), this might be a service or action")


def check_is_valid_srv_type(srv_type: Any) -> None:
    """Accept a service class.

    Raises:
        What check_for_type_support raises, and RuntimeError for a message.
    """
    check_for_type_support(srv_type)
    if not issubclass(srv_type, Service):
        raise RuntimeError(f"The service type provided is not valid ({srv_type}), this might be a message or action")
