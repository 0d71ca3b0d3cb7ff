"""Messages to CDR bytes and back."""

from __future__ import annotations

from typing import Any

from rclpy.type_support import check_for_type_support
from rclpy_dds.interfaces.codec import decoder, encoder


def serialize_message(message: Any) -> bytes:
    """Return a message as CDR with its encapsulation header."""
    check_for_type_support(type(message))
    return encoder(message.__ros_name__)(message)


def deserialize_message(serialized_message: bytes, message_type: Any) -> Any:
    """Return the message that CDR bytes hold.

    Raises:
        MalformedSample: they hold none of this type.
    """
    check_for_type_support(message_type)
    return decoder(message_type.__ros_name__)(bytes(serialized_message))
