"""The `ros2` command, in processes of its own, with the spelling and output of ROS 2's."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool

from contract.commands import Command, calls_services, in_the_end, needs_ros2
from contract.commands import run as _run
from contract.conftest import Graph, Program

pytestmark = needs_ros2


LATCHED = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_lists_show_what_is_there(graph: Graph) -> None:
    node = graph.node("sim", namespace="/rig")
    node.create_publisher(Float64, "volts", 10)
    output = in_the_end(graph, "/rig/volts", "topic", "list", "-t")
    assert "/rig/volts [std_msgs/msg/Float64]" in output.splitlines()
    assert "/rig/sim" in in_the_end(graph, "/rig/sim", "node", "list", "--spin-time", "3").splitlines()
    assert "/rig/sim/set_parameters" in in_the_end(graph, "/rig/sim", "service", "list").splitlines()
    information = in_the_end(graph, "/rig/volts", "node", "info", "/rig/sim", "--spin-time", "3")
    assert "  Publishers:\n" in information and "    /rig/volts: std_msgs/msg/Float64\n" in information
    assert in_the_end(graph, "Publisher count: 1", "topic", "info", "-v", "/rig/volts")


def test_echo_prints_yaml(graph: Graph) -> None:
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    graph.node("speaker").create_publisher(String, "word", latched).publish(String(data="Öl: 5"))
    # a command that has not discovered the publisher yet says so and ends
    assert in_the_end(graph, "data:", "topic", "echo", "--once", "/word") == "data: 'Öl: 5'\n---\n"


def test_pub_sends_the_number_asked_for(graph: Graph) -> None:
    received: list[float] = []
    graph.node("listener").create_subscription(Float64, "x", lambda message: received.append(message.data), 10)
    status, output, _ = _run(graph, "topic", "pub", "-t", "3", "-r", "50", "/x", "std_msgs/msg/Float64", "{data: 1e-3}")
    assert status == 0 and "publishing #3: std_msgs.msg.Float64(data=0.001)" in output
    assert graph.spin_until(lambda: len(received) >= 3)
    assert received == [0.001] * 3


def test_hz_tells_the_rate(graph: Graph) -> None:
    node = graph.node("speaker")
    publisher = node.create_publisher(Float64, "x", 10)
    sent: list[float] = []

    def send() -> None:
        publisher.publish(Float64())
        sent.append(time.monotonic())

    node.create_timer(0.01, send)
    with Command("topic", "hz", "/x") as command:
        assert graph.spin_until(lambda: publisher.get_subscription_count() == 1, 15.0)
        end = time.monotonic() + 2.5  # it tells once a second
        sent.clear()
        graph.spin_until(lambda: time.monotonic() > end)
        command.interrupt()
        output = command.result()[1]
    rate = float(output.split("average rate: ")[1].split()[0])
    assert rate == pytest.approx((len(sent) - 1) / (sent[-1] - sent[0]), rel=0.2)  # 100, but on a busy machine


@calls_services
def test_parameters_are_set_got_and_described(graph: Graph) -> None:
    node = graph.node("sim")
    node.declare_parameter("leakage", 1e-12)
    done = "Set parameter successful\n"
    assert in_the_end(graph, done, "param", "set", "/sim", "leakage", "1.0e-10") == done
    assert node.get_parameter("leakage").value == 1e-10
    assert _run(graph, "param", "get", "/sim", "leakage")[1] == "Double value is: 1e-10\n"
    assert "  leakage\n" in _run(graph, "param", "list", "/sim")[1]
    assert "Parameter name: leakage\n  Type: double\n" in _run(graph, "param", "describe", "/sim", "leakage")[1]
    errors = _run(graph, "param", "set", "/sim", "leakage", "text")[2]
    assert errors.startswith("Setting parameter failed: Wrong parameter type")
    assert _run(graph, "param", "get", "/nobody", "leakage")[::2] == (1, "Node not found\n")


@calls_services
def test_a_service_is_called(graph: Graph) -> None:
    def answer(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        response.success, response.message = request.data, "set"
        return response

    graph.node("server").create_service(SetBool, "switch", answer)
    status, output, _ = _run(graph, "service", "call", "/switch", "std_srvs/srv/SetBool", "{data: true}")
    assert status == 0
    assert "requester: making request: std_srvs.srv.SetBool_Request(data=True)" in output
    assert "response:\nstd_srvs.srv.SetBool_Response(success=True, message='set')" in output


def test_a_recording_is_made_described_and_played(graph: Graph, tmp_path: Path) -> None:
    node = graph.node("speaker")
    publisher = node.create_publisher(Float64, "x", 10)
    sent: list[float] = []

    def send() -> None:
        sent.append(float(len(sent)))
        publisher.publish(Float64(data=sent[-1]))

    timer = node.create_timer(0.01, send)
    timer.cancel()
    bag = tmp_path / "bag"
    with Command("bag", "record", "-s", "mcap", "-o", str(bag), "--topics", "/x") as recorder:
        assert graph.spin_until(lambda: publisher.get_subscription_count() == 1, 15.0)
        timer.reset()
        assert graph.spin_until(lambda: len(sent) >= 50)
        timer.cancel()
        end = time.monotonic() + 0.5
        graph.spin_until(lambda: time.monotonic() > end)
        recorder.interrupt()
        assert recorder.result()[0] == 0
    assert ": &" not in (bag / "metadata.yaml").read_text()  # aliases, which careful readers refuse
    information = _run(None, "bag", "info", str(bag))[1]
    assert f"Topic: /x | Type: std_msgs/msg/Float64 | Count: {len(sent)} | Serialization Format: cdr" in information
    received: list[float] = []
    node.create_subscription(Float64, "/again", lambda message: received.append(message.data), 1000)
    # Slowly, after a while: ROS 2's own waits for nobody and sends what belongs to its first tenth of a second at once.
    status, output, errors = _run(graph, "bag", "play", str(bag), "-r", "0.5", "-d", "1", "-m", "/x:=/again")
    assert status == 0 and "[rosbag2_player]: " in output + errors
    assert graph.spin_until(lambda: len(received) == len(sent)) and received == sent


def test_what_is_recorded_and_played_can_be_chosen_by_pattern(graph: Graph, tmp_path: Path) -> None:
    node, bag, names = graph.node("speaker"), tmp_path / "bag", ("/rig/a", "/rig/b", "/rig/c", "/other")
    publishers = [node.create_publisher(Float64, name, 10) for name in names]
    timer = node.create_timer(0.02, lambda: [publisher.publish(Float64(data=1.0)) for publisher in publishers])
    chosen = ["-e", "^/rig", "--exclude-topics", "/rig/b"]
    with Command("bag", "record", "-s", "mcap", "-o", str(bag), *chosen) as recorder:
        assert graph.spin_until(lambda: all(publishers[i].get_subscription_count() == 1 for i in (0, 2)), 15.0)
        assert not graph.spin_until(lambda: any(publishers[i].get_subscription_count() for i in (1, 3)), 1.0)
        recorder.interrupt()
        assert recorder.result()[0] == 0
    timer.cancel()
    heard: set[str] = set()
    for name in names:
        node.create_subscription(Float64, name, lambda _, name=name: heard.add(name), 10)
    assert _run(graph, "bag", "play", str(bag), "-d", "1", "-e", "/rig/.", "-x", ".*c")[0] == 0
    assert graph.spin_until(lambda: heard)
    assert heard == {"/rig/a"}


LAUNCHED = """#!{python}
import rclpy
from rclpy.executors import ExternalShutdownException
try:
    rclpy.init()
    node = rclpy.create_node("launched")
    node.declare_parameter("gain", 0.0)
    node.get_logger().info(f"up as {{node.get_fully_qualified_name()}} with {{node.get_parameter('gain').value}}")
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
finally:
    rclpy.try_shutdown()
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Install a package with one executable and one launch file in a prefix of its own."""
    executable = tmp_path / "lib" / "some_package" / "node"
    executable.parent.mkdir(parents=True)
    executable.write_text(LAUNCHED.format(python=sys.executable))
    executable.chmod(0o755)
    share = tmp_path / "share" / "some_package"
    (share / "launch").mkdir(parents=True)
    (share / "package.xml").write_text("<package><name>some_package</name></package>")
    index = tmp_path / "share" / "ament_index" / "resource_index" / "packages"
    index.mkdir(parents=True)
    (index / "some_package").touch()
    (share / "launch" / "one.launch.yaml").write_text(
        "launch:\n- arg: {name: gain, default: '1.5'}\n"
        "- node:\n    pkg: some_package\n    exec: node\n    namespace: rig\n    name: renamed\n    output: screen\n"
        "    param:\n    - {name: gain, value: $(var gain)}\n"
    )
    before = os.environ.get("AMENT_PREFIX_PATH")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path}{os.pathsep}{before}" if before else str(tmp_path))
    return tmp_path


def _heard(graph: Graph, text: str) -> bool:
    """Tell whether a node says a text on /rosout in time."""
    heard: list[str] = []
    graph.node("observer").create_subscription(Log, "/rosout", lambda log: heard.append(log.msg), LATCHED)
    return graph.spin_until(lambda: text in heard, 20.0)


def _appears(graph: Graph, name: str) -> bool:
    """Tell whether a node is found in time: its name may be discovered later than its first message."""
    return graph.spin_until(lambda: name in graph.nodes[0].get_fully_qualified_node_names())


def test_run_starts_a_node_and_ends_with_it(package: Path, graph: Graph) -> None:
    with Command("run", "some_package", "node", "--ros-args", "-p", "gain:=2.5", "-r", "__ns:=/a") as command:
        assert _heard(graph, "up as /a/launched with 2.5")
        assert _appears(graph, "/a/launched")
        command.interrupt()
        status, _, errors = command.result()
    assert status == 0 and "up as /a/launched with 2.5" in errors


def test_launch_starts_and_ends_what_the_file_says(package: Path, graph: Graph) -> None:
    with Command("launch", "some_package", "one.launch.yaml", "gain:=3.5") as command:
        assert _heard(graph, "up as /rig/renamed with 3.5")
        assert _appears(graph, "/rig/renamed")
        command.process.send_signal(signal.SIGINT)  # which launch passes on
        status, output, errors = command.result()
    assert status == 0, errors
    assert "up as /rig/renamed with 3.5" in output + errors
    observer = graph.nodes[0]
    assert graph.spin_until(lambda: "/rig/renamed" not in observer.get_fully_qualified_node_names(), 2.0)


@calls_services
def test_parameters_of_another_process(graph: Graph, program: Callable[..., Program]) -> None:
    source = (
        "import rclpy; rclpy.init(); n = rclpy.create_node('far'); n.declare_parameter('a', 1); "
        "print('ready'); rclpy.spin(n)"
    )
    program(source).wait_for("ready")
    assert in_the_end(None, "Set parameter successful", "param", "set", "/far", "a", "5")
    assert _run(None, "param", "get", "--hide-type", "/far", "a")[1] == "5\n"
