"""A running simulator under garbage on its ports, hostile commands, a flood of calls, and pauses of its process."""

from __future__ import annotations

import math
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tools.hostile.extent import Extent
from tools.hostile.row import Row

DOMAIN = 88
CALLS = 600
"""Service calls under way at once."""
PATIENCE = 90.0
"""s for an answer; a first start compiles the plant."""
MOST_MEMORY = 700_000
"""kB that the simulator may reach."""


def try_nodes(extent: Extent, seed: int) -> list[Row]:
    """Start a simulator, harm it, and ask after each harm whether it still answers as it should."""
    os.environ["ROS_DOMAIN_ID"] = str(DOMAIN)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    with tempfile.TemporaryDirectory() as temporary:
        log = Path(temporary) / "sim.log"
        with log.open("wb") as output:
            command = [sys.executable, "-m", "eha_sim_node.sim"]
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, cwd=temporary)
        try:
            with _silent():
                return _harm(process, log, extent, seed)
        finally:
            process.kill()
            process.wait()


@contextmanager
def _silent() -> Iterator[None]:
    """Nothing on standard error, where the DDS library tells of each malformed datagram that it, too, gets."""
    former, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    try:
        yield
    finally:
        os.dup2(former, 2)
        os.close(nowhere)
        os.close(former)


def _harm(process: subprocess.Popen[bytes], log: Path, extent: Extent, seed: int) -> list[Row]:
    import rclpy
    from rclpy.node import Node

    chance = random.Random(seed)
    rclpy.init()
    node = Node("hostile")
    user = _User(node)
    harms: dict[str, Callable[[], None]] = {
        "garbage to the DDS ports, 200 datagrams": lambda: _garbage(chance),
        f"{CALLS} service calls at once": user.call_at_once,
        "hostile commands, 100 messages": lambda: user.command(chance),
        "hostile steps and parameters": lambda: user.step_and_set(chance),
        "process stopped and continued": lambda: _pause(process, chance),
    }
    rows = {name: Row(f"simulator node: {name}", seed) for name in harms}
    try:
        user.wait_for_services()
        course, rounds = extent.begin(), 0
        while not course.over(rounds) and process.poll() is None:
            rounds += 1
            for name, harm in harms.items():
                try:
                    harm()
                    fault = user.fault() or _process_fault(process, log)
                except TimeoutError as error:
                    fault = str(error)
                rows[name].fail(fault) if fault else rows[name].count("answered after it")
                if process.poll() is not None:
                    break
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return list(rows.values())


def _process_fault(process: subprocess.Popen[bytes], log: Path) -> str | None:
    if process.poll() is not None:
        return f"ended with {process.returncode}: {log.read_text(errors='replace')[-500:]}"
    if "Traceback" in log.read_text(errors="replace"):
        return log.read_text(errors="replace")[-500:]
    status = Path(f"/proc/{process.pid}/status").read_text()
    peak = int(next(line.split()[1] for line in status.splitlines() if line.startswith("VmHWM")))
    return f"{peak} kB of memory" if peak > MOST_MEMORY else None


def _garbage(chance: random.Random) -> None:
    """Datagrams to the ports that RTPS gives the domain's first participants: noise, and headers with noise behind."""
    ports = [7400 + 250 * DOMAIN + offset for offset in (0, 1, 10, 11, 12, 13, 14, 15)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for _ in range(200):
            body = chance.randbytes(chance.choice((0, 1, 20, 100, 1400, 60_000)))
            head = b"RTPS\x02\x05\x01\x10" + chance.randbytes(12) + bytes([chance.randrange(256), 1, 0xFF, 0xFF])
            sender.sendto(chance.choice((body, head + body[:1400])), ("127.0.0.1", chance.choice(ports)))


def _pause(process: subprocess.Popen[bytes], chance: random.Random) -> None:
    process.send_signal(signal.SIGSTOP)
    time.sleep(chance.uniform(0.05, 2.0))
    process.send_signal(signal.SIGCONT)


class _User:
    """Talks to the simulator as a controller does."""

    def __init__(self, node: Any) -> None:
        from rcl_interfaces.srv import GetParameters, SetParameters
        from rclpy.qos import qos_profile_parameters
        from sensor_msgs.msg import JointState
        from std_msgs.msg import Float64

        from eha_interfaces.srv import Step

        self._node = node
        self._stamp = 0
        self._heard: list[Any] = []
        # Of replies that nobody takes, a client of the default quality keeps ten.
        many = {"qos_profile": qos_profile_parameters}
        self._parameters = node.create_client(GetParameters, "/eha_sim/get_parameters", **many)
        self._set = node.create_client(SetParameters, "/eha_sim/set_parameters")
        self._step = node.create_client(Step, "/eha_sim/step")
        self._commands = node.create_publisher(Float64, "/voltage_command", 10)
        node.create_subscription(JointState, "/joint_states", self._heard.append, 1000)

    def wait_for_services(self) -> None:
        """Wait until the simulator is there."""
        self._wait(lambda: self._parameters.service_is_ready() and self._heard, "no simulator")

    def call_at_once(self) -> None:
        """Ask for a parameter many times without waiting, then wait for all answers."""
        futures = [self._ask() for _ in range(CALLS)]
        self._wait(lambda: all(future.done() for future in futures), "not every call was answered")

    def command(self, chance: random.Random) -> None:
        """Publish voltages of any kind."""
        from std_msgs.msg import Float64

        for _ in range(100):
            volts = chance.choice((math.nan, math.inf, -math.inf, 1e308, -1e-320, chance.uniform(-0.1, 0.1)))
            self._commands.publish(Float64(data=volts))

    def step_and_set(self, chance: random.Random) -> None:
        """Ask for steps while it runs and set parameters to what they cannot be."""
        from rclpy.parameter import Parameter

        values = (math.nan, 1e300, -1.0, "text", True, [1.0, 2.0], 1)
        names = ("moving_mass", "internal_leakage", "supply_pressure", "no_such", "step_size", "x" * 5000)
        for _ in range(20):
            given = Parameter(chance.choice(names), value=chance.choice(values)).to_parameter_msg()
            request = self._set.srv_type.Request(parameters=[given]) if chance.random() < 0.5 else None
            if request is None:
                steps = self._step.srv_type.Request(steps=chance.choice((0, 1, 4_294_967_295)))
                future = self._step.call_async(steps)
            else:
                future = self._set.call_async(request)
            self._wait(future.done, "a hostile request was not answered")

    def fault(self) -> str | None:
        """What is wrong with the simulator now: silent, backwards in time, or beyond its stroke."""
        self._heard.clear()
        answer = self._ask()
        self._wait(lambda: answer.done() and len(self._heard) > 5, "the simulator fell silent")
        for message in self._heard:
            stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
            if stamp <= self._stamp:
                return f"stamp {stamp} after {self._stamp}"
            self._stamp = stamp
            if not abs(message.position[0]) <= 0.1 + 1e-9:
                return f"position {message.position[0]} m"
        return None

    def _ask(self) -> Any:
        return self._parameters.call_async(self._parameters.srv_type.Request(names=["moving_mass"]))

    def _wait(self, condition: Callable[[], Any], otherwise: str) -> None:
        import rclpy

        deadline = time.monotonic() + PATIENCE
        while not condition():
            rclpy.spin_once(self._node, timeout_sec=0.02)
            if time.monotonic() > deadline:
                raise TimeoutError(otherwise)
