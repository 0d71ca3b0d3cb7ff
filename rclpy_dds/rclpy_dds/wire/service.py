"""Requests and replies as rmw_cyclonedds_cpp sends them: a header of client and number before the message."""

from __future__ import annotations

import itertools
import struct
from dataclasses import dataclass
from typing import Any

from cyclonedds._clayer import ddspy_get_matched_publication_data, ddspy_get_matched_subscription_data
from cyclonedds.builtin_types import endpoint_constructor
from cyclonedds.qos import Policy

from rclpy_dds.interfaces.codec import HEADER, MalformedSample, decoder, encoder
from rclpy_dds.wire.discovered import discovered_qos
from rclpy_dds.wire.entities import matched_handles
from rclpy_dds.wire.interruptions import held_off

_counter = itertools.count(1)
_LAYOUT = struct.Struct("<Qq")
_HEADER_SIZE = len(HEADER) + _LAYOUT.size


@dataclass(frozen=True)
class RequestId:
    """Which client asked, and its number for the request."""

    client: int
    number: int


def encode(message: Any, request_id: RequestId) -> bytes:
    """Return a request or reply as CDR. The header is 16 bytes, so the message's own alignment does not change."""
    body = encoder(message.__ros_name__)(message)
    return HEADER + _LAYOUT.pack(request_id.client, request_id.number) + body[len(HEADER) :]


def decode(data: bytes, type_name: str) -> tuple[Any, RequestId]:
    """Return message and id of a request or reply.

    Raises:
        MalformedSample: the bytes hold none.
    """
    if len(data) < _HEADER_SIZE:
        raise MalformedSample(f"{len(data)} bytes are no {type_name} with a request header")
    client, number = _LAYOUT.unpack_from(data, len(HEADER))
    return decoder(type_name)(data[: len(HEADER)] + data[_HEADER_SIZE:]), RequestId(client, number)


def new_endpoint_id(participant_gid: bytes) -> str:
    """Return a new id of a service or client as rmw_cyclonedds_cpp spells it in user data.

    It is the participant's first twelve bytes and a counter, in unpadded hex; the first byte is padded with a blank.
    """
    identity = participant_gid[:12] + struct.pack(">I", next(_counter))
    return f"{identity[0]:2x}." + ".".join(f"{byte:x}" for byte in identity[1:])


@held_off()
def matched_ids(entity: int, key: str, *, writer: bool) -> set[str]:
    """Return the ids under `key` ("serviceid", "clientid") of the endpoints a writer or reader is matched with."""
    data = ddspy_get_matched_subscription_data if writer else ddspy_get_matched_publication_data
    endpoints = (
        data(entity, handle, endpoint_constructor, discovered_qos) for handle in matched_handles(entity, writer=writer)
    )
    return {_user_data(endpoint, key) for endpoint in endpoints if endpoint is not None}


@held_off()
def reply_can_arrive(reader: int, writer: int, request_writer: int) -> bool:
    """Tell whether a service's reply writer has found the reply reader of the client that sent a request.

    Args:
        reader: the service's reader of requests. writer: its writer of replies.
        request_writer: the instance handle of the client's writer, from the request's sample info.
    """
    endpoint = ddspy_get_matched_publication_data(reader, request_writer, endpoint_constructor, discovered_qos)
    client = _user_data(endpoint, "clientid") if endpoint is not None else ""
    return not client or client in matched_ids(writer, "clientid", writer=True)


def _user_data(endpoint: Any, key: str) -> str:
    data = endpoint.qos[Policy.Userdata].data if Policy.Userdata in endpoint.qos else b""
    for part in data.decode("ascii", "replace").split(";"):
        name, _, value = part.partition("=")
        if name == key:
            return value
    return ""
