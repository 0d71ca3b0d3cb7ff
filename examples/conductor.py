"""What the demonstrations do to the graph: start the node processes, set parameters, call services, listen."""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from eha_core.errors import EhaError
from eha_interfaces.msg import TrackingError
from eha_interfaces.srv import Step

OUT = Path(__file__).resolve().parents[1] / "out" / "demo"
_HALF_PERIOD = 1e-3  # s, of the samples
INSTRUMENTS = ("voltage_command", "joint_states", "chamber_a/pressure", "chamber_b/pressure")
SIMULATOR_TOPICS = (*INSTRUMENTS, "state")
_START = 120.0  # s; the first node compiles the plant, on a machine that may be busy
PIECE = 0.5  # s of simulated time a lockstep takes before the monitor has caught up: half of what a queue holds
_SETTLE = 0.5  # s; the monitor counts its diagnostics too, so the run's last messages may still be on their way
_END = 15.0  # s for a node to finish what it writes


class DemoError(Exception):
    """The demonstration cannot go on; the message says why."""


def perform(name: str, demonstrate: Callable[[], None]) -> int:
    """Run a demonstration; return its exit status, with one line on standard error where it failed."""
    # A domain of its own on this machine only: a demonstration must not meet somebody's rig.
    os.environ.setdefault("ROS_DOMAIN_ID", str(46 + os.getpid() % 56))
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # the nodes must not outlive it
    try:
        demonstrate()
    except (DemoError, EhaError, OSError) as error:
        print(f"{name}: {' '.join(str(error).split())}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    return 0


def perform_on_a_rig(name: str, description: str, demonstrate: Callable[[Path, int | None], Path]) -> int:
    """Run a demonstration on a rig whose faults a seed draws, in a folder, as the command line says, and say which page
    it made; return its exit status."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--out", type=Path, default=OUT, help="folder for all that is written")
    parser.add_argument("--seed", type=int, help="conceal what this seed draws (default: another each time)")
    arguments = parser.parse_args()
    out = arguments.out.resolve()

    def demonstrated() -> None:
        began = time.monotonic()
        out.mkdir(parents=True, exist_ok=True)
        page = demonstrate(out, arguments.seed)
        print(f"{time.monotonic() - began:.0f} s; open {os.path.relpath(page)}", flush=True)

    return perform(name, demonstrated)


class Processes:
    """The node processes; their output goes to one log file each."""

    def __init__(self, logs: Path) -> None:
        self._logs = logs
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        logs.mkdir(parents=True, exist_ok=True)

    def start(self, executable: str, *arguments: str) -> None:
        """Start a node as `ros2 run eha_sim_node <executable>` does."""
        self.start_program(executable, "-m", f"eha_sim_node.{executable}", "--ros-args", *arguments)

    def start_program(self, name: str, *words: str) -> None:
        """Start Python with these words; `name` is that of its log."""
        with (self._logs / f"{name}.log").open("wb") as log:
            self._running[name] = subprocess.Popen([sys.executable, *words], stdout=log, stderr=subprocess.STDOUT)

    def check(self) -> None:
        """Raise DemoError with the last line of a node's log if it has ended."""
        for name, process in self._running.items():
            if process.poll() is not None:
                lines = (self._logs / f"{name}.log").read_text(errors="replace").strip().splitlines() or ["no output"]
                raise DemoError(f"{name} ended with status {process.returncode}: {lines[-1]}")

    def stop(self, *names: str) -> None:
        """End these nodes, or all: the monitor first so that it finishes its file."""
        for name in names or sorted(self._running, key=lambda one: one != "monitor"):
            process = self._running.pop(name, None)
            if process is None or process.poll() is not None:
                continue
            process.send_signal(signal.SIGINT)
            try:
                process.wait(timeout=_END)
            except subprocess.TimeoutExpired:
                process.kill()
                with suppress(subprocess.TimeoutExpired):
                    process.wait(timeout=_END)


class Conductor:
    """Steps a simulator, or a rig that is one, and watches the graph, with an ordinary node's means.

    `recorder` is the node that has to listen to every topic before anything moves.
    """

    recorder = "eha_monitor"

    def __init__(self, processes: Processes, simulator: str = "eha_sim", step_size: float = 1e-4) -> None:
        rclpy.init()
        self._processes = processes
        self._node = rclpy.create_node("eha_demo")
        self._step_size = step_size
        self._step = self._node.create_client(Step, f"{simulator}/step")
        self._reset = self._node.create_client(Trigger, "eha_monitor/reset")
        self._clients = [self._step, self._reset]

    def wait(self, until: Callable[[], bool], seconds: float, what: str) -> None:
        """Serve the node until something is true; raise DemoError when it takes too long."""
        deadline = time.monotonic() + seconds
        while not until():
            rclpy.spin_once(self._node, timeout_sec=0.05)
            self._processes.check()
            if time.monotonic() > deadline:
                raise DemoError(f"waited {seconds:g} s for {what}")

    def await_nodes(self, recorded: Iterable[str] = SIMULATOR_TOPICS) -> None:
        """Wait until the services answer and the monitor has subscribed to all that it is to record."""
        self.wait(lambda: all(client.service_is_ready() for client in self._clients), _START, "the nodes' services")
        self.wait(lambda: all(map(self._is_recorded, recorded)), 30, f"{self.recorder} to subscribe to every topic")

    def _is_recorded(self, topic: str) -> bool:
        return any(info.node_name == self.recorder for info in self._node.get_subscriptions_info_by_topic(topic))

    def _call(self, client: Any, request: Any) -> Any:
        future = client.call_async(request)
        self.wait(future.done, 10, f"an answer of {client.srv_name}")
        return future.result()

    def step(self, seconds: float) -> None:
        """Let a paused simulator take so many simulated seconds."""
        answer = self._call(self._step, Step.Request(steps=round(seconds / self._step_size)))
        if not answer.success:
            raise DemoError(f"the simulator does not step: {answer.message}")

    def close(self) -> None:
        """Leave the graph."""
        self._node.destroy_node()
        rclpy.try_shutdown()


class RigConductor(Conductor):
    """Lets a rig run until its recording of `topics` is complete."""

    def __init__(
        self,
        processes: Processes,
        simulator: str = "eha_sim",
        step_size: float = 1e-4,
        topics: tuple[str, ...] = SIMULATOR_TOPICS,
    ) -> None:
        super().__init__(processes, simulator, step_size)
        self._topics = topics
        self._recorded, self._reached = 0, 0.0
        self._node.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, 100)
        self._node.create_subscription(JointState, "joint_states", self._on_state, 1)

    def _on_diagnostics(self, message: Any) -> None:
        for status in message.status:
            if status.name == "eha_monitor":
                self._recorded = int({item.key: item.value for item in status.values}["messages"])

    def _on_state(self, message: Any) -> None:
        self._reached = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9

    def run(self, seconds: float, period: float, patience: float) -> None:
        """Let the rig run for so many simulated seconds, and the monitor write all that came of them.

        A lockstep can outrun the monitor: what a queue no longer holds is lost, and so is a queue when its node ends.
        """
        for piece in range(1, round(seconds / PIECE) + 1):
            self.step(PIECE)
            self._await_state(piece * PIECE, patience)
            messages = (len(self._topics) + 1) * (round(piece * PIECE / period) + 1)  # with /clock, and with the start
            self._await_written(messages, patience)
        settled = time.monotonic() + _SETTLE
        self.wait(lambda: time.monotonic() > settled, patience, "the last of them")

    def _await_state(self, instant: float, patience: float) -> None:
        """Wait for the state that ends a step. The count of messages does not tell it: other topics are in it too."""
        self.wait(lambda: instant - self._reached < _HALF_PERIOD, patience, f"the rig at {instant:g} s")

    def _await_written(self, messages: int, patience: float) -> None:
        self.wait(lambda: self._recorded >= messages, patience, f"the monitor to write {messages} messages")


class LeakageConductor(Conductor):
    """Turns the leakage and watches the error."""

    def __init__(self, processes: Processes) -> None:
        super().__init__(processes)
        self.error = TrackingError()
        self._node.create_subscription(TrackingError, "tracking_error", self._on_error, 1000)
        self._parameters = self._node.create_client(SetParameters, "eha_sim/set_parameters")
        self._clients.append(self._parameters)

    @property
    def stamp(self) -> float:
        """Stamp of the newest error [s]."""
        return self.error.header.stamp.sec + self.error.header.stamp.nanosec * 1e-9

    def _on_error(self, message: Any) -> None:
        self.error = message

    def follow(self, until: float, show: Callable[[], None]) -> None:
        """Wait until the errors have come to an instant [s], showing how far they are."""

        def reached() -> bool:
            show()
            return until - self.stamp < _HALF_PERIOD

        self.wait(reached, 120, f"the error at {until:g} s")

    def run(self, seconds: float, show: Callable[[], None]) -> None:
        """Let a paused simulator run for so many simulated seconds, no faster than the monitor can follow."""
        start = self.stamp
        for piece in range(1, round(seconds / PIECE) + 1):
            self.step(PIECE)
            self.follow(start + piece * PIECE, show)

    def turn_leakage(self, coefficient: float) -> None:
        """Set internal_leakage [m^3/(s Pa)] by the parameter service, and let the errors count from here."""
        value = Parameter("internal_leakage", value=coefficient).to_parameter_msg()
        result = self._call(self._parameters, SetParameters.Request(parameters=[value])).results[0]
        if not result.successful:
            raise DemoError(f"internal_leakage {coefficient:g} was refused: {result.reason}")
        self._call(self._reset, Trigger.Request())
