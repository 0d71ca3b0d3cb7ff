"""The live page node: the rig in a browser, with a slider for its leakage, where no Foxglove is at hand."""

from __future__ import annotations

import queue
import sys
import threading
import time
from collections.abc import Callable, Mapping

import rclpy.node
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import SetParameters
from rclpy.clock import Clock, ClockType
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from rclpy.task import Future
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import Float64

from eha_core.errors import EhaError
from eha_core.parameters import catalogue
from eha_sim_node.joints import value_of
from eha_sim_node.live.server import PageServer
from eha_sim_node.parameters import ParameterSet, Row, Value
from eha_sim_node.running import run
from eha_sim_node.stamps import nanoseconds_of
from eha_sim_node.state_topics import LATCHED

NAME = "eha_live_page"
_NEWEST = QoSProfile(depth=1, reliability=QoSReliabilityPolicy.BEST_EFFORT)
_PERIOD = 0.05  # s between two looks for what the page asked for
_SILENT = 2.5  # s without a report after which the twin is taken for gone
OWN_ROWS = (
    Row("address", "127.0.0.1", "interface that the page is served on; 0.0.0.0 lets the whole network turn the leakage",
        fixed=True),
    Row("port", 8080, "TCP port of the page; 0: any that is free", 0, 65_535, fixed=True),
    Row("simulator", "eha_sim", "node whose internal_leakage the page turns", fixed=True),
    Row("twin", "eha_twin", "node whose /diagnostics say what departs", fixed=True),
)  # fmt: skip


class LivePageNode(rclpy.node.Node):
    """Topics -> the latest values -> page; page -> internal_leakage of the simulator."""

    def __init__(self) -> None:
        super().__init__(NAME, automatically_declare_parameters_from_overrides=True)
        self._settings = ParameterSet(self, OWN_ROWS)
        own = self._settings.values
        self._settings.declare(_refuse_changes)
        self._lock = threading.Lock()
        self._values: dict[str, object] = {"stroke": catalogue()["actuator_displacement"].nominal, "refused": ""}
        self._twin = f"{self.get_namespace().rstrip('/')}/{own['twin']}"
        self._twin_heard = 0.0
        self._wanted: queue.SimpleQueue[float] = queue.SimpleQueue()
        self._simulator = self.create_client(SetParameters, f"{own['simulator']}/set_parameters")
        self.create_subscription(JointState, "joint_states", self._on_joint_states, _NEWEST)
        self.create_subscription(JointState, "reference", self._on_reference, _NEWEST)
        for chamber in "ab":
            self.create_subscription(
                FluidPressure, f"chamber_{chamber}/pressure", self._pressure_receiver(chamber), _NEWEST
            )
        self.create_subscription(Float64, "internal_leakage", self._on_leakage, LATCHED)
        self.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, 10)
        self.create_timer(_PERIOD, self._on_timer, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._server = PageServer(own["address"], own["port"], self._snapshot, self._wanted.put)
        self.get_logger().info(f"the rig is at {self._server.url}")

    def close(self) -> None:
        """Stop serving."""
        self._server.close()

    def _note(self, **values: object) -> None:
        with self._lock:
            self._values.update(values)

    def _snapshot(self) -> Mapping[str, object]:
        with self._lock:
            known = dict(self._values)
        if time.monotonic() - self._twin_heard > _SILENT:
            known.pop("twin", None)
        return known

    def _on_joint_states(self, message: JointState) -> None:
        fields = {"position": message.position, "velocity": message.velocity, "force": message.effort}
        found = {name: value_of(message.name, values) for name, values in fields.items()}
        self._note(time=nanoseconds_of(message.header.stamp) * 1e-9, **found)

    def _on_reference(self, message: JointState) -> None:
        self._note(reference=value_of(message.name, message.position))

    def _pressure_receiver(self, chamber: str) -> Callable[[FluidPressure], None]:
        def receive(message: FluidPressure) -> None:
            self._note(**{f"pressure_{chamber}": message.fluid_pressure})

        return receive

    def _on_leakage(self, message: Float64) -> None:
        self._note(internal_leakage=message.data)

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.hardware_id == self._twin:
                self._twin_heard = time.monotonic()
                self._note(twin={"departs": status.level != status.OK, "message": status.message})

    def _on_timer(self) -> None:
        wanted = None
        while not self._wanted.empty():
            wanted = self._wanted.get()  # of a slider that was dragged, where it is now
        if wanted is None:
            return
        if not self._simulator.service_is_ready():
            self._note(refused="there is no simulator whose leakage could be turned")
            return
        value = Parameter("internal_leakage", value=wanted).to_parameter_msg()
        self._simulator.call_async(SetParameters.Request(parameters=[value])).add_done_callback(self._on_answer)

    def _on_answer(self, future: Future) -> None:
        result = future.result().results[0]
        self._note(refused="" if result.successful else result.reason)


def _refuse_changes(changes: Mapping[str, Value]) -> None:
    raise EhaError(f"{', '.join(changes)} cannot change while the page is served")


def main() -> int:
    """Run the live page node."""
    return run(LivePageNode, NAME)


if __name__ == "__main__":
    sys.exit(main())
