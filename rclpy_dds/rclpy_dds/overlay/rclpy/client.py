"""Calling a service."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.dds_qos import to_dds
from rclpy.endpoint import Endpoint
from rclpy.exceptions import InvalidHandle, RCLError
from rclpy.qos import QoSProfile
from rclpy.task import Future
from rclpy_dds.interfaces.codec import MalformedSample
from rclpy_dds.wire import entities, names, service
from rclpy_dds.wire.hashes import type_hash

_POLL = 0.02


class Client(Endpoint):
    """Sends requests and hands out futures of the replies; made by Node.create_client."""

    def __init__(
        self, node: Any, srv_type: Any, srv_name: str, qos_profile: QoSProfile, callback_group: CallbackGroup
    ) -> None:
        super().__init__(node)
        self.context = node.context
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.qos_profile = qos_profile
        self.callback_group = callback_group
        self._logger = node.get_logger()
        self._executor_of = lambda: node.executor
        self._pending_requests: dict[int, Future] = {}
        self._lock = threading.RLock()
        self._number = 0
        self._id = random.SystemRandom().getrandbits(64)
        type_name = srv_type.__ros_name__
        identity = service.new_endpoint_id(node.context.graph.gid)
        qos = to_dds(qos_profile, f"clientid={identity};typehash={type_hash(type_name)};")
        request_topic, reply_topic = names.dds_service(srv_name)
        self._entity, self.condition = self._reader(reply_topic, f"{type_name}_Response", qos)
        self._request_writer = self._writer(request_topic, f"{type_name}_Request", qos)
        node.context.graph.add_endpoints(self._entry, readers=(self._entity,), writers=(self._request_writer,))

    @property
    def service_name(self) -> str:
        """Return the service's fully qualified name."""
        return self.srv_name

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Send a request and wait for the reply while another thread spins the node.

        Returns:
            The reply, None when the time ran out.

        Raises:
            TypeError: the request is of another type.
        """
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"Expected {self.srv_type.Request}, got {type(request)}")
        event = threading.Event()

        def unblock(_: Any) -> None:
            event.set()

        unblock._immediate = True  # type: ignore[attr-defined]  # a waiting executor thread could not run it
        future = self.call_async(request)
        future.add_done_callback(unblock)
        if not event.wait(timeout_sec):
            self.remove_pending_request(future)
            return None
        if future.exception() is not None:
            raise future.exception()
        return future.result()

    def call_async(self, request: Any) -> Future:
        """Send a request and return the future of its reply.

        Raises:
            TypeError: the request is of another type.
        """
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"Expected {self.srv_type.Request}, got {type(request)}")
        if self._destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        with self._lock:
            self._number += 1
            number = self._number
            future = Future(executor=self._executor_of())
            self._pending_requests[number] = future
            future.add_done_callback(_immediate(self.remove_pending_request))
        try:
            entities.write(self._request_writer, service.encode(request, service.RequestId(self._id, number)))
        except entities.EntityError as error:
            self.remove_pending_request(future)
            raise RCLError(f"failed to send request: {error}") from None
        return future

    def remove_pending_request(self, future: Future) -> None:
        """Forget a request, so that its reply is dropped."""
        with self._lock:
            self._pending_requests = {n: known for n, known in self._pending_requests.items() if known is not future}

    def service_is_ready(self) -> bool:
        """Tell whether one and the same server is matched in both directions.

        From then on a request arrives: Cyclone DDS keeps it until the server, which may still be discovering this
        client, acknowledges it; and the server answers a client when it has found where to.
        """
        if self._destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        if not (entities.matched(self._request_writer, writer=True) and entities.matched(self._entity, writer=False)):
            return False
        takers = service.matched_ids(self._request_writer, "serviceid", writer=True)
        return bool(takers & service.matched_ids(self._entity, "serviceid", writer=False))

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait until a server is there; False when the time ran out or the context ended."""
        end = None if timeout_sec is None or timeout_sec < 0 else time.monotonic() + timeout_sec
        while self.context.ok() and not self.service_is_ready():
            if end is not None and time.monotonic() >= end:
                return False
            time.sleep(_POLL)
        return self.context.ok()

    def _take(self) -> tuple[Future, Any] | None:
        taken = entities.take(self._entity)
        if not taken or self._destroyed or not taken[1].valid_data:
            return None
        try:
            reply, request_id = service.decode(taken[0], f"{self.srv_type.__ros_name__}_Response")
        except MalformedSample as error:
            self._logger.error(f"dropped a malformed reply of '{self.srv_name}': {error}")
            return None
        if request_id.client != self._id:
            return None
        with self._lock:
            future = self._pending_requests.get(request_id.number)
        return None if future is None else (future, reply)

    def _handle(self, taken: tuple[Future, Any]) -> None:
        future, reply = taken
        future._set_executor(self._executor_of())
        future.set_result(reply)

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy()


def _immediate(callback: Callable[[Future], None]) -> Callable[[Future], None]:
    """Return the callback as one that runs where the future is set, not in an executor."""

    def run(future: Future) -> None:
        callback(future)

    run._immediate = True  # type: ignore[attr-defined]
    return run
