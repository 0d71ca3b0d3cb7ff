"""Services and clients."""

from __future__ import annotations

import threading

import pytest
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from std_srvs.srv import Empty, SetBool, Trigger

from contract.conftest import Graph, Program


def _answer(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
    response.success, response.message = request.data, "set"
    return response


def test_a_call_is_answered(graph: Graph) -> None:
    graph.node("server").create_service(SetBool, "switch", _answer)
    client = graph.node("client").create_client(SetBool, "switch")
    assert client.wait_for_service(5.0)
    future = client.call_async(SetBool.Request(data=True))
    assert graph.spin_until(future.done)
    assert future.result() == SetBool.Response(success=True, message="set")


def test_replies_reach_the_client_that_asked(graph: Graph) -> None:
    graph.node("server").create_service(SetBool, "switch", _answer)
    clients = [graph.node(f"client{i}").create_client(SetBool, "switch") for i in range(3)]
    assert all(client.wait_for_service(5.0) for client in clients)
    futures = [client.call_async(SetBool.Request(data=i % 2 == 0)) for i, client in enumerate(clients)]
    assert graph.spin_until(lambda: all(future.done() for future in futures))
    assert [future.result().success for future in futures] == [True, False, True]


def test_an_empty_request_and_reply(graph: Graph) -> None:
    calls = []
    graph.node("server").create_service(Empty, "poke", lambda request, response: (calls.append(request), response)[1])
    client = graph.node("client").create_client(Empty, "poke")
    assert client.wait_for_service(5.0)
    future = client.call_async(Empty.Request())
    assert graph.spin_until(future.done)
    assert calls == [Empty.Request()] and future.result() == Empty.Response()


def test_a_coroutine_may_serve_and_call_another_service(graph: Graph) -> None:
    node = graph.node("relay")
    graph.node("server").create_service(SetBool, "switch", _answer)
    inner = node.create_client(SetBool, "switch", callback_group=MutuallyExclusiveCallbackGroup())

    async def relay(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        reply = await inner.call_async(SetBool.Request(data=True))
        response.success, response.message = reply.success, f"relayed {reply.message}"
        return response

    node.create_service(Trigger, "relay", relay)
    client = graph.node("client").create_client(Trigger, "relay")
    assert client.wait_for_service(5.0) and inner.wait_for_service(5.0)
    future = client.call_async(Trigger.Request())
    assert graph.spin_until(future.done)
    assert future.result() == Trigger.Response(success=True, message="relayed set")


def test_a_blocking_call_works_beside_a_spinning_thread(graph: Graph) -> None:
    node = rclpy.create_node("both")
    node.create_service(SetBool, "switch", _answer)
    client = node.create_client(SetBool, "switch")
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    try:
        assert client.wait_for_service(5.0)
        assert client.call(SetBool.Request(data=True)).success
    finally:
        executor.shutdown(2.0)
        thread.join(5.0)
        node.destroy_node()
    assert not thread.is_alive()


def test_a_missing_service_is_told_in_time(graph: Graph) -> None:
    client = graph.node("client").create_client(Empty, "nobody")
    assert not client.service_is_ready()
    assert not client.wait_for_service(0.1)


def test_a_request_of_another_type_is_refused(graph: Graph) -> None:
    client = graph.node("client").create_client(Empty, "poke")
    with pytest.raises(TypeError):
        client.call_async(SetBool.Request())


SERVER = """
import rclpy
from std_srvs.srv import SetBool
rclpy.init()
node = rclpy.create_node("server")
def answer(request, response):
    response.success = not request.data
    return response
node.create_service(SetBool, "switch", answer)
print("ready")
try:
    rclpy.spin(node)
except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
    pass
"""


def test_the_first_call_to_another_process_is_answered(graph: Graph, program: type[Program]) -> None:
    program(SERVER).wait_for("ready")
    for _ in range(5):  # a new client each time: the reply must not outrun discovery
        client = graph.node("client").create_client(SetBool, "switch")
        assert client.wait_for_service(5.0)
        future = client.call_async(SetBool.Request(data=False))
        assert graph.spin_until(future.done)
        assert future.result().success
        graph.nodes[-1].destroy_client(client)
