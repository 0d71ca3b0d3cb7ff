"""Answering a service."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import CoroutineType, SimpleNamespace
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.dds_qos import to_dds
from rclpy.endpoint import Endpoint
from rclpy.exceptions import RCLError
from rclpy.qos import QoSProfile
from rclpy_dds.interfaces.codec import MalformedSample
from rclpy_dds.wire import entities, names, service
from rclpy_dds.wire.hashes import type_hash

# Replies are volatile: a reply sent before discovery has matched the client's reader is lost. Once per client the
# server waits for that (s); a client that has gone ends the wait, so only a very busy machine uses it up.
_WAIT_FOR_READER = 5.0


class Service(Endpoint):
    """Hands requests to a function and sends what it returns; made by Node.create_service."""

    def __init__(
        self,
        node: Any,
        srv_type: Any,
        srv_name: str,
        callback: Callable[..., Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
    ) -> None:
        super().__init__(node)
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.callback = callback
        self.callback_group = callback_group
        self.qos_profile = qos_profile
        self._logger = node.get_logger()
        self._reachable: set[int] = set()
        type_name = srv_type.__ros_name__
        identity = service.new_endpoint_id(node.context.graph.gid)
        qos = to_dds(qos_profile, f"serviceid={identity};typehash={type_hash(type_name)};")
        request_topic, reply_topic = names.dds_service(srv_name)
        self._reply_writer = self._writer(reply_topic, f"{type_name}_Response", qos)
        self._entity, self.condition = self._reader(request_topic, f"{type_name}_Request", qos)
        node.context.graph.add_endpoints(self._entry, readers=(self._entity,), writers=(self._reply_writer,))

    @property
    def service_name(self) -> str:
        """Return the service's fully qualified name."""
        return self.srv_name

    def _take(self) -> tuple[Any, Any, int] | None:
        taken = entities.take(self._entity)
        if not taken or self._destroyed or not taken[1].valid_data:
            return None
        data, info = taken
        try:
            request, request_id = service.decode(data, f"{self.srv_type.__ros_name__}_Request")
        except MalformedSample as error:
            self._logger.error(f"dropped a malformed request to '{self.srv_name}': {error}")
            return None
        return request, request_id, info.publication_handle

    def service_take_request(self, request_type: Any = None) -> tuple[Any, Any]:
        """Take one request and its info at once, without an executor; (None, None) when there is none."""
        taken = entities.take(self._entity)
        if not taken or not taken[1].valid_data:
            return None, None
        data, info = taken
        request, request_id = service.decode(data, f"{self.srv_type.__ros_name__}_Request")
        return request, SimpleNamespace(
            request_id=request_id, source_timestamp=info.source_timestamp, received_timestamp=time.time_ns()
        )

    def _handle(self, taken: tuple[Any, Any, int]) -> Any:
        request, request_id, writer = taken
        response = self.callback(request, self.srv_type.Response())
        if type(response) is CoroutineType:
            return self._answer_later(response, request_id, writer)
        self._answer(response, request_id, writer)
        return None

    async def _answer_later(self, coroutine: Any, request_id: Any, writer: int) -> None:
        self._answer(await coroutine, request_id, writer)

    def _answer(self, response: Any, request_id: Any, writer: int) -> None:
        end = time.monotonic() + _WAIT_FOR_READER
        while writer not in self._reachable:
            if service.reply_can_arrive(self._entity, self._reply_writer, writer) or time.monotonic() > end:
                self._reachable.add(writer)
            else:
                time.sleep(0.001)
        self.send_response(response, request_id)

    def send_response(self, response: Any, header: Any) -> None:
        """Send a reply.

        Raises:
            TypeError: it is of another type.
        """
        if not isinstance(response, self.srv_type.Response):
            raise TypeError(f"Expected {self.srv_type.Response}, got {type(response)}")
        if self._destroyed:
            return
        try:
            entities.write(self._reply_writer, service.encode(response, header))
        except entities.EntityError as error:
            raise RCLError(f"failed to send response: {error}") from None

    def __enter__(self) -> Service:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy()
