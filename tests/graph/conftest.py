"""Starts the real node processes on DDS, in a domain of their own, and talks to them as a controller would."""

from __future__ import annotations

import itertools
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

# Ports of domains above 101 collide with Linux' ephemeral ones.
os.environ["ROS_DOMAIN_ID"] = os.environ.get("EHA_TEST_DOMAIN_ID", str(46 + os.getpid() % 56))
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from std_msgs.msg import Float64

_NUMBERS = itertools.count(1)
_PATIENCE = 90.0  # s; a node compiles its plant on its first start, on a machine that may be busy


class NodeProcess:
    """One node as a process of its own, whose output goes to a log."""

    def __init__(self, log: Path, command: list[str], **options: Any) -> None:
        self.log = log
        with log.open("wb") as output:
            self.process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, cwd=log.parent, **options)

    @property
    def output(self) -> str:
        """What the node has printed so far."""
        return self.log.read_text(errors="replace")

    def end(self, number: int = signal.SIGINT, seconds: float = 15.0) -> int:
        """Send a signal and return the exit status."""
        if self.process.poll() is None:
            self.process.send_signal(number)
        return self.wait(seconds)

    def wait(self, seconds: float = _PATIENCE) -> int:
        """Return the exit status; a node that does not end in time is killed and fails the test."""
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            pytest.fail(f"the node did not end within {seconds} s; it printed:\n{self.output}")


class Rig:
    """A user's side of one test: a node in the test's namespace, and the processes it has started."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.namespace = f"/rig{next(_NUMBERS)}"
        self.node = Node("test_controller", namespace=self.namespace)
        self.processes: list[NodeProcess] = []
        self.commands = self.node.create_publisher(Float64, "voltage_command", 10)

    def start(self, executable: str, *parameters: str, name: str = "", **options: Any) -> NodeProcess:
        """Start a node with `name:=value` parameters; other arguments (`--params-file x`) go as they are."""
        arguments = [part for given in parameters for part in (["-p", given] if ":=" in given else [given])]
        log = self.folder / f"{name or executable}-{len(self.processes)}.log"
        command = [sys.executable, "-m", f"eha_sim_node.{executable}", "--ros-args", "-r", f"__ns:={self.namespace}"]
        process = NodeProcess(log, command + arguments, **options)
        self.processes.append(process)
        return process

    def start_sim(self, *parameters: str) -> NodeProcess:
        """Start the simulator and return once it answers."""
        process = self.start("sim", *parameters)
        self.client_ready("eha_sim/get_parameters")
        return process

    def client_ready(self, service: str) -> None:
        """Wait until a service is in the graph."""
        full = f"{self.namespace}/{service}"
        self.wait(
            lambda: full in {name for name, _ in self.node.get_service_names_and_types()}, f"the service {service}"
        )

    def wait(self, condition: Callable[[], Any], what: str, seconds: float = _PATIENCE) -> Any:
        """Serve the node until the condition holds, and return its value."""
        deadline = time.monotonic() + seconds
        while not (value := condition()):
            rclpy.spin_once(self.node, timeout_sec=0.02)
            if time.monotonic() > deadline:
                printed = "\n".join(process.output for process in self.processes)
                pytest.fail(f"waited {seconds} s for {what}; the nodes printed:\n{printed}")
        return value

    def spin(self, seconds: float) -> None:
        """Serve the node for some time."""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            rclpy.spin_once(self.node, timeout_sec=min(left, 0.02))

    def hear(self, message_type: type, topic: str, qos: Any = 1000, **options: Any) -> list[Any]:
        """Return a list that grows with every message of a topic, once its publisher is matched."""
        heard: list[Any] = []
        self.node.create_subscription(message_type, topic, heard.append, qos, **options)
        self.wait(lambda: self.node.count_publishers(topic), f"a publisher of {topic}")
        return heard

    def call(self, service_type: Any, service: str, **fields: Any) -> Any:
        """Call a service and return its answer."""
        client = self.node.create_client(service_type, service)
        self.wait(client.service_is_ready, f"the service {service}")
        future = client.call_async(service_type.Request(**fields))
        self.wait(future.done, f"an answer of {service}")
        self.node.destroy_client(client)
        return future.result()

    def command(self, volts: float, seconds: float, rate: float = 100.0) -> None:
        """Publish a steady voltage for some time."""
        self.wait(lambda: self.commands.get_subscription_count() > 0, "the simulator's command input")
        for _ in range(round(seconds * rate)):
            self.commands.publish(Float64(data=volts))
            self.spin(1.0 / rate)

    def diagnostics(self, node: str) -> list[dict[str, str]]:
        """Return a list that grows with each report of a node: its values, and `message` and `level`."""
        reports: list[dict[str, str]] = []

        def on_message(message: DiagnosticArray) -> None:
            for status in message.status:
                if status.hardware_id == f"{self.namespace}/{node}":
                    values = {item.key: item.value for item in status.values}
                    reports.append({**values, "message": status.message, "level": str(status.level)})

        self.node.create_subscription(DiagnosticArray, "/diagnostics", on_message, 10)
        return reports

    def close(self) -> None:
        """End what was started."""
        for process in self.processes:
            if process.process.poll() is None:
                process.process.send_signal(signal.SIGINT)
        for process in self.processes:
            try:
                process.process.wait(10)
            except subprocess.TimeoutExpired:
                process.process.kill()
                process.process.wait()
        self.node.destroy_node()


@pytest.fixture(scope="session", autouse=True)
def middleware() -> Iterator[None]:
    """One ROS context for the session."""
    rclpy.init()
    yield
    rclpy.try_shutdown()


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[Rig]:
    """A user's side in a namespace of its own; ends its processes."""
    made = Rig(tmp_path)
    yield made
    made.close()
