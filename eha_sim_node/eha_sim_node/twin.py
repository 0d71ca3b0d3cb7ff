"""The twin node: a model beside a running rig, on the same command, that says which of its equations the rig leaves,
what is the likely cause, and records the seconds about it."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import rclpy.node
from rclpy.clock import Clock, ClockType
from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import Float64

from eha_core.errors import EhaError, ParameterError
from eha_core.plant import voltage_driven
from eha_core.realtime import NANOSECONDS
from eha_core.report.departure import as_values, likely_cause
from eha_core.twin import Comparison, Settings, Twin
from eha_core.twin.departures import MOST
from eha_core.twin.explanation import Explanation
from eha_core.twin.follow_up import FollowUp, News
from eha_core.twin.snapshot import Snapshots
from eha_interfaces.msg import ActuatorState
from eha_sim_node.diagnostics import Diagnostics, Report
from eha_sim_node.joints import JOINT, value_of
from eha_sim_node.parameters import ParameterSet, Row, Value, plant_rows, plant_values
from eha_sim_node.running import run
from eha_sim_node.stamps import nanoseconds_of

NAME = "eha_twin"
_PERIOD = 0.05  # s between two looks whether a window is complete
_SILENCE = 5.0  # s beyond the window's length without a comparison until that is said
# Best effort matches whatever a rig's drivers publish; a simulator in lockstep may be faster than the twin.
_QUALITY = QoSProfile(depth=10_000, reliability=QoSReliabilityPolicy.BEST_EFFORT)
OWN_ROWS = (
    Row("model", "", "parameters file of the model, as the simulator takes it (fitted.yaml); empty: nominal",
        fixed=True),
    Row("step_size", 1e-4, "step of the model [s]", 1e-6, 1e-3, fixed=True),
    Row("window", 1.0, "time after which the model is put back to the measured state [s]", 0.2, 3600.0, fixed=True),
    Row("threshold", 1.5, "how many times the noise an equation may be off [-]", 1.0, 1e6, fixed=True),
    Row("false_alarm_hours", 10_000.0, "mean time until an equation seems to be off by chance [h]", 1.0, 1e9,
        fixed=True),
    Row("position_noise", 10e-6, "least noise of the position that is reckoned with [m]", 1e-12, 1.0, fixed=True),
    Row("pressure_noise", 1e4, "least noise of the pressures that is reckoned with [Pa]", 1e-3, 1e8, fixed=True),
    Row("command_timeout", 0.5, "time without a command until the rig's drive falls to zero [s]; 0: never",
        0.0, 3600.0, fixed=True),
    Row("command_limit", 10.0, "largest voltage that the rig's drive takes, either sign [V]", 0.0, 1000.0, fixed=True),
    Row("name_causes", True, "whether a second process names the likely cause of a departure", fixed=True),
    Row("snapshot_folder", "", "folder for recordings of the seconds about each departure; empty: none", fixed=True),
    Row("snapshot_before", 10.0, "how much of what came before the alarm a snapshot holds [s]", 1.0, 600.0, fixed=True),
    Row("snapshot_after", 5.0, "how much of what comes after the alarm a snapshot holds [s]", 0.0, 600.0, fixed=True),
    Row("diagnostics_rate", 1.0, "rate of /diagnostics, in wall-clock time [Hz]", 0.1, 100.0, fixed=True),
)  # fmt: skip
_SETTINGS = (
    "window", "threshold", "false_alarm_hours", "position_noise", "pressure_noise", "command_timeout", "command_limit",
)  # fmt: skip


class TwinNode(rclpy.node.Node):
    """The rig's topics -> twin -> /diagnostics."""

    def __init__(self) -> None:
        super().__init__(NAME, automatically_declare_parameters_from_overrides=True)
        self._settings = ParameterSet(self, (*OWN_ROWS, *self._plant_rows()))
        own = self._settings.values
        before, after = own["snapshot_before"], own["snapshot_after"]
        settings = Settings(**{name: own[name] for name in _SETTINGS}, kept=max(before, MOST))
        self._twin = Twin(plant_values(own), own["step_size"], settings)
        self._follow_up = FollowUp(own["name_causes"], own["snapshot_folder"], Snapshots(before, after))
        self._failure = ""
        self._settings.declare(self._apply)
        self._latest: Comparison | None = None
        self._windows = 0
        self._compared_at = time.monotonic()
        self._patience = own["window"] + _SILENCE
        self.create_subscription(Float64, "voltage_command", self._on_command, _QUALITY)
        self.create_subscription(JointState, "joint_command", self._on_joint_command, _QUALITY)
        self.create_subscription(JointState, "joint_states", self._on_joint_states, _QUALITY)
        self.create_subscription(ActuatorState, "state", self._on_state, _QUALITY)
        for chamber in "ab":
            self.create_subscription(
                FluidPressure, f"chamber_{chamber}/pressure", self._pressure_receiver(chamber), _QUALITY
            )
        self.create_timer(_PERIOD, self._on_timer, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self._diagnostics = Diagnostics(self, own["diagnostics_rate"], self._report)
        self.get_logger().info(f"beside the rig with {own['model'] or 'the parameters given'}")

    def _plant_rows(self) -> list[Row]:
        """The plant's parameters, whose defaults are those of the model's file."""
        given = self.get_parameter("model").value if self.has_parameter("model") else ""
        if not isinstance(given, str):
            raise ParameterError(f"model = {given!r} is no path of a parameters file")
        return plant_rows(voltage_driven(given) if given else None)

    def _apply(self, changes: Mapping[str, Value]) -> None:
        fixed = [row.name for row in OWN_ROWS if row.name in changes]
        if fixed:
            raise ParameterError(f"{', '.join(fixed)} cannot change while the twin runs")
        self._twin.set_parameters(plant_values(changes))

    def _on_command(self, message: Float64, info: Mapping[str, Any]) -> None:
        self._twin.command(_published(info), message.data)

    def _on_joint_command(self, message: JointState, info: Mapping[str, Any]) -> None:
        voltage = value_of(message.name, message.effort)
        if voltage is not None:
            self._twin.command(_published(info), voltage)

    def _on_state(self, message: ActuatorState) -> None:
        self._twin.applied(nanoseconds_of(message.header.stamp), message.voltage)

    def _on_joint_states(self, message: JointState, info: Mapping[str, Any]) -> None:
        position = value_of(message.name, message.position)
        if position is not None:
            self._twin.position(nanoseconds_of(message.header.stamp), position, _published(info))

    def _pressure_receiver(self, chamber: str) -> Callable[[FluidPressure], None]:
        def receive(message: FluidPressure) -> None:
            gauge = message.fluid_pressure - self._twin.parameters["atmospheric_pressure"]
            self._twin.pressure(chamber, nanoseconds_of(message.header.stamp), gauge)

        return receive

    def close(self) -> None:
        """Finish the snapshot under way."""
        self._log(self._follow_up.close())

    def _on_timer(self) -> None:
        if news := self._follow_up.collect():
            self._log(news)
            self._diagnostics.publish()
        comparison = self._twin.compare()
        if comparison is None:
            return
        self._follow_up.take(comparison, self._twin.kept, self._twin.parameters)
        before = _news(self._latest) if self._latest else set()
        self._latest = comparison
        self._windows += 1
        self._compared_at = time.monotonic()
        if _news(comparison) == before:
            return
        self._diagnostics.publish()  # news does not wait for the next report
        if troubles := [*_unsound(comparison), *_departures(comparison)]:
            self.get_logger().warning("; ".join(troubles))
        else:
            self.get_logger().info("the rig follows the model again")

    def _log(self, news: Iterable[News]) -> None:
        for one in news:
            self._failure = str(one) if isinstance(one, EhaError) else ""
            if isinstance(one, Explanation):
                self.get_logger().warning(likely_cause(one))
            elif isinstance(one, Path):
                self.get_logger().info(f"the seconds about the departure are in {one}")
            else:
                self.get_logger().error(self._failure)

    def _report(self) -> Report:
        troubles = []
        silent = time.monotonic() - self._compared_at
        if silent > self._patience:
            troubles.append(
                f"nothing to compare for {silent:.0f} s; joint_states must come without gaps, with a joint {JOINT}"
            )
        troubles += [self._failure] if self._failure else []
        values: dict[str, object] = {"windows": self._windows}
        if self._latest:
            latest = self._latest
            troubles += [*_unsound(latest), *_departures(latest)]
            values |= {"window_start": _stamp(latest.start), "window_end": _stamp(latest.end)}
            values |= {f"rmse {name}": error for name, error in latest.errors.items()}
            values |= {f"times the noise: {name}": ratio for name, ratio in latest.ratios.items()}
            values |= {f"{what} since: {name}": _stamp(since) for name, (what, since) in latest.unsound.items()}
            values |= {f"departs since: {name}": _stamp(since) for name, since in latest.departs.items()}
        if explanation := self._follow_up.explanation:
            troubles.append(likely_cause(explanation))
            values |= as_values(explanation)
        if self._follow_up.snapshot:
            values["snapshot"] = self._follow_up.snapshot
        return Report(values, troubles)


def _news(comparison: Comparison) -> set[tuple[str, str]]:
    """What is reported of a comparison as soon as it changes."""
    departing = {(name, "departs") for name in comparison.departs}
    return departing | {(name, what) for name, (what, _) in comparison.unsound.items()}


def _unsound(comparison: Comparison) -> list[str]:
    """One line for each channel with which nothing can be compared."""
    return [f"{name} is {what} since {_stamp(since)} s" for name, (what, since) in comparison.unsound.items()]


def _departures(comparison: Comparison) -> list[str]:
    """One line for each equation that departs, the most first."""
    return [
        f"{name} departs by {_times(comparison.ratios[name])} times the noise since {_stamp(since)} s"
        for name, since in comparison.departs.items()
    ]


def _times(ratio: float) -> str:
    return f"{ratio:,.0f}" if ratio >= 100.0 else f"{ratio:.3g}"


def _stamp(nanoseconds: int) -> str:
    return f"{nanoseconds / NANOSECONDS:.3f}"


def _published(info: Mapping[str, Any]) -> int:
    return int(info["source_timestamp"]) or time.time_ns()


def main() -> int:
    """Run the twin node."""
    return run(TwinNode, NAME, OWN_ROWS)


if __name__ == "__main__":
    sys.exit(main())
