"""The monitor node: how well the piston follows its reference, and a recording of everything in the namespace."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import rclpy.node
from rcl_interfaces.srv import GetParameters
from rclpy.clock import Clock, ClockType
from rclpy.parameter import parameter_value_to_python
from rclpy.serialization import deserialize_message
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from eha_core.errors import EhaError, RecordingError
from eha_core.recording import is_finished
from eha_core.tracking import Tracker, TrackingSample
from eha_interfaces.msg import TrackingError
from eha_sim_node.diagnostics import Diagnostics, Report
from eha_sim_node.joints import value_of
from eha_sim_node.parameters import ParameterSet, Row, Value, plant_rows, plant_values
from eha_sim_node.recorder import Handler, Recorder
from eha_sim_node.running import run
from eha_sim_node.stamps import nanoseconds_of, set_stamp
from eha_sim_node.state_topics import OUTPUT_QUALITY

NAME = "eha_monitor"
_DISCOVERY_PERIOD = 0.1  # s
_FLUSH_PERIOD = 0.25  # s
_FEW_UNPAIRED = 0.05  # share of positions without a reference that an RMSE stands; assumed
_PLANT = [row.name for row in plant_rows()]
OWN_ROWS = (
    Row("directory", "bags", "folder that recordings go to", fixed=True),
    Row("name", "", "file name of the recording without ending; empty: from the date", fixed=True),
    Row("record", True, "whether a recording starts with the node", fixed=True),
    Row("window", 1.0, "length of the sliding window of rmse_window [s]", 1e-3, 3600.0, fixed=True),
    Row("simulator", "eha_sim", "node whose parameters the recording keeps", fixed=True),
    Row("log_period", 10.0, "time between two log lines about the error [s]", 0.1, 3600.0, fixed=True),
    Row("diagnostics_rate", 1.0, "rate of /diagnostics, in wall-clock time [Hz]", 0.1, 100.0, fixed=True),
)


class MonitorNode(rclpy.node.Node):
    """joint_states and reference -> tracker -> tracking_error; every topic -> recorder."""

    def __init__(self) -> None:
        super().__init__(NAME, automatically_declare_parameters_from_overrides=True)
        self._settings = ParameterSet(self, OWN_ROWS)
        own = self._settings.values
        self._window = own["window"]
        self._tracker = Tracker(window=self._window)
        self._publisher = self.create_publisher(TrackingError, "tracking_error", OUTPUT_QUALITY)
        self._message = TrackingError()
        self._reported = (0, 0)  # pairs and positions without one, at the last report
        handlers: dict[str, Handler] = {
            self.resolve_topic_name("joint_states"): self._on_measured,
            self.resolve_topic_name("reference"): self._on_reference,
        }
        simulated = bool(self.get_parameter("use_sim_time").value)
        self._directory = Path(own["directory"])
        self._recorder = Recorder(self, self._directory, own["name"], simulated, handlers)
        self._settings.declare(_refuse_changes)
        for name in ("start", "stop", "split"):
            self.create_service(Trigger, f"~/{name}", self._recording_service(getattr(self._recorder, name)))
        self.create_service(Trigger, "~/reset", self._on_reset)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(_DISCOVERY_PERIOD, self._on_discovery, clock=steady)
        self.create_timer(_FLUSH_PERIOD, self._recorder.flush, clock=steady)
        self.create_timer(own["log_period"], self._on_log, clock=steady)
        self._simulator = self.create_client(GetParameters, f"{own['simulator']}/get_parameters")
        self._asked_simulator = False
        self._diagnostics = Diagnostics(self, own["diagnostics_rate"], self._report)
        if own["record"]:
            self._start_recording()

    def close(self) -> None:
        """Finish the recording."""
        if self._recorder.path:
            self.get_logger().info(f"recorded {self._recorder.message_count} messages to {self._recorder.stop()}")

    def _start_recording(self) -> None:
        self._tell_unfinished()
        try:
            self.get_logger().info(f"recording to {self._recorder.start()}")
        except RecordingError as error:
            self.get_logger().error(f"not recording, monitoring goes on: {error}")

    def _tell_unfinished(self) -> None:
        """Say what the last recorder left behind, if it was killed."""
        try:
            latest = max(self._directory.glob("*.mcap"), key=lambda path: path.stat().st_mtime, default=None)
            if latest is not None and not is_finished(latest):
                self.get_logger().warning(
                    f"{latest} was not finished: its recorder was killed, or is running still; it can be read as it is,"
                    " and lacks what came after its last flush"
                )
        except OSError:
            pass  # a folder that cannot be read is reported when the recording starts

    def _on_measured(self, data: bytes) -> None:
        message = deserialize_message(data, JointState)
        position = value_of(message.name, message.position)
        if position is not None:
            self._publish(self._tracker.measured(nanoseconds_of(message.header.stamp), position))

    def _on_reference(self, data: bytes) -> None:
        message = deserialize_message(data, JointState)
        position = value_of(message.name, message.position)
        if position is not None:
            self._publish(self._tracker.reference(nanoseconds_of(message.header.stamp), position))

    def _publish(self, pairs: Iterable[TrackingSample]) -> None:
        message = self._message
        for pair in pairs:
            set_stamp(message.header.stamp, pair.stamp)
            message.error = pair.error
            message.rmse_window = pair.rmse_window
            message.rmse = pair.rmse
            message.largest_error = pair.largest_error
            message.sample_count = pair.count
            self._publisher.publish(message)

    def _on_discovery(self) -> None:
        self._recorder.discover()
        if path := self._recorder.resume():
            self.get_logger().info(f"recording goes on in {path}")
        if not self._asked_simulator and self._simulator.service_is_ready():
            self._asked_simulator = True
            request = GetParameters.Request(names=_PLANT)
            self._simulator.call_async(request).add_done_callback(self._on_parameters)

    def _on_parameters(self, future: Future) -> None:
        values = future.result().values
        if len(values) == len(_PLANT):
            found = {name: parameter_value_to_python(value) for name, value in zip(_PLANT, values, strict=True)}
            self._recorder.keep_parameters(plant_values(found))

    def _recording_service(
        self, act: Callable[[], Path]
    ) -> Callable[[Trigger.Request, Trigger.Response], Trigger.Response]:
        def serve(request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
            try:
                response.message = str(act())
                response.success = True
            except RecordingError as error:
                response.message = str(error)
                self.get_logger().error(str(error))
            return response

        return serve

    def _on_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._tracker.reset()
        self._message.sample_count = 0
        self._reported = (0, 0)
        response.success = True
        response.message = "the errors count from here"
        return response

    def _on_log(self) -> None:
        message = self._message
        if message.sample_count:
            self.get_logger().info(
                f"error {message.error * 1e3:.4f} mm,"
                f" RMSE {message.rmse * 1e3:.4f} mm over {message.sample_count} samples,"
                f" {message.rmse_window * 1e3:.4f} mm over the last {self._window:g} s"
            )

    def _report(self) -> Report:
        recorder = self._recorder
        troubles = [f"not recording: {recorder.failure}"] if recorder.failure else []
        troubles += self._missing_pairs()
        troubles += [f"{topic} is not recorded: {reason}" for topic, reason in recorder.unrecorded.items()]
        values = {
            "recording": recorder.path or "",
            "messages": recorder.message_count,
            "topics": " ".join(sorted(recorder.topics)),
            "samples": self._message.sample_count,
            "unpaired": self._tracker.unpaired,
            "rmse": self._message.rmse,
        }
        return Report(values, troubles)

    def _missing_pairs(self) -> list[str]:
        """Positions since the last report that found no reference, where they are more than a few."""
        paired, unpaired = self._message.sample_count, self._tracker.unpaired
        new = paired - self._reported[0], unpaired - self._reported[1]
        self._reported = (paired, unpaired)
        if new[1] <= _FEW_UNPAIRED * sum(new):
            return []
        return [f"{new[1]} of {sum(new)} positions have no reference: the RMSE rests on the other {max(new[0], 0)}"]


def _refuse_changes(changes: Mapping[str, Value]) -> None:
    raise EhaError(f"{', '.join(changes)} cannot change while the monitor runs")


def main() -> int:
    """Run the monitor node."""
    return run(MonitorNode, NAME, OWN_ROWS)


if __name__ == "__main__":
    sys.exit(main())
