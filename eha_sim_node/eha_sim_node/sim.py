"""The simulator node: a plant that takes volts and publishes what a rig's sensors would say."""

from __future__ import annotations

import sys
from collections.abc import Mapping

import rclpy.node
from std_srvs.srv import SetBool, Trigger

from eha_core.errors import EhaError, ParameterError
from eha_core.plant import Plant
from eha_core.realtime import NANOSECONDS, CommandInput
from eha_interfaces.srv import Step
from eha_sim_node.command_topics import CommandTopics, each, newest
from eha_sim_node.diagnostics import Diagnostics, Report
from eha_sim_node.parameters import (
    ParameterSet,
    Row,
    Value,
    given_composition,
    part_rows,
    plant_rows,
    plant_values,
)
from eha_sim_node.running import compile_plant, run
from eha_sim_node.standard_services import StandardServices
from eha_sim_node.state_topics import StateTopics
from eha_sim_node.time_modes import Lockstep, PacedTime, TimeMode

NAME = "eha_sim"
_SLICE = 100_000  # steps whose voltages are in memory at once
OWN_ROWS = (
    Row("step_size", 1e-4, "time the plant is advanced by in one step [s]", 1e-6, 1e-3, fixed=True),
    Row("publish_rate", 500.0, "rate of the published state, in simulated time [Hz]", 0.1, 10_000.0, fixed=True),
    Row(
        "time_mode",
        "realtime",
        "who drives time: the wall clock; the wall clock times real_time_factor; or the commands, one a period",
        fixed=True,
        choices=("realtime", "scaled", "lockstep"),
    ),
    Row("real_time_factor", 1.0, "simulated seconds per wall-clock second in time_mode scaled [-]", 1e-3, 1e3),
    Row(
        "command_timeout",
        0.5,
        "simulated time without a command until the voltage falls to zero [s]; 0: never",
        0.0,
        3600.0,
    ),
    Row("command_limit", 10.0, "largest voltage that the drive takes, either sign [V]; assumed", 0.0, 1000.0),
    Row(
        "lockstep_patience",
        0.01,  # a period of 2 ms at a fifth of the wall clock's pace; a timer's command comes within a few ms (assumed)
        "wall-clock time that a period in time_mode lockstep waits for its command before it is taken with the voltage"
        " in force [s], once the controller has left a tick unanswered for 5 s; 0: for ever",
        0.0,
        3600.0,
        fixed=True,
    ),
    Row("catch_up_limit", 0.5, "longest backlog that is made up for after a stall [s]", 0.0, 60.0, fixed=True),
    Row("initial_position", 0.0, "piston position at the start and after a reset [m]", -10.0, 10.0, fixed=True),
    Row("clock_rate", 0.0, "rate of /clock, in simulated time [Hz]; 0: publish_rate", 0.0, 10_000.0, fixed=True),
    Row(
        "start_paused",
        False,
        "whether the simulator waits for the service ~/pause or ~/step before it runs",
        fixed=True,
    ),
    Row("frame_id", "", "frame of the published headers", fixed=True),
    *part_rows(),
    Row("diagnostics_rate", 1.0, "rate of /diagnostics, in wall-clock time [Hz]", 0.1, 100.0, fixed=True),
)


class SimNode(rclpy.node.Node):
    """Parameters -> plant; commands -> plant; time mode -> periods -> topics."""

    def __init__(self) -> None:
        super().__init__(NAME, automatically_declare_parameters_from_overrides=True)
        self._parts = given_composition(self)
        if self._parts.source.valve != "coil":
            raise ParameterError(
                f"plant.source = {self._parts.source.id} takes {' and '.join(self._parts.source.inputs)}, and this node"
                " takes voltages; `eha simulate` takes recorded ones"
            )
        self._settings = ParameterSet(self, (*OWN_ROWS, *plant_rows(composition=self._parts)))
        own = self._settings.values
        values = plant_values(own, self._parts)
        self._plant = Plant(values, own["step_size"], own["initial_position"], self._parts)
        self._steps = _steps_per_period(own["step_size"], own["publish_rate"])
        self._step_ns = round(own["step_size"] * NANOSECONDS)
        self._period = self._steps * own["step_size"]
        self._earlier_steps = 0  # steps before the last reset: time goes on when the plant starts anew
        self._command = CommandInput(own["command_limit"], own["command_timeout"])
        owns_time = own["time_mode"] != "realtime"
        self._topics = StateTopics(self, own["frame_id"], _clock_period(own) if owns_time else None)
        self._settings.declare(self._apply)
        self._time: TimeMode = (Lockstep if own["time_mode"] == "lockstep" else PacedTime)(self, own)
        self._reported = (0, 0)
        self._told: set[str] = set()
        self._commands = CommandTopics(self, self._on_command, each if own["time_mode"] == "lockstep" else newest)
        self.create_service(SetBool, "~/pause", self._on_pause)
        self.create_service(Trigger, "~/reset", self._on_reset)
        self.create_service(Step, "~/step", self._on_step)
        self._standard = StandardServices(self, self._time) if StandardServices.available() else None
        self._diagnostics = Diagnostics(self, own["diagnostics_rate"], self._report)
        self._topics.publish_leakage(self._plant.state.internal_leakage)
        self.get_logger().info(
            f"{own['time_mode']}: step {own['step_size']:g} s, {own['publish_rate']:g} Hz"
            + (", paused" if own["start_paused"] else "")
        )

    @property
    def steps_per_period(self) -> int:
        """Plant steps between two published states."""
        return self._steps

    @property
    def period(self) -> float:
        """Simulated time between two published states [s]."""
        return self._period

    @property
    def elapsed(self) -> int:
        """Simulated time since the node's start [ns]; a reset does not set it back."""
        return (self._earlier_steps + self._plant.step_count) * self._step_ns

    @property
    def peers(self) -> tuple[int, int]:
        """How many commanders and how many subscribers are matched."""
        return self._commands.commanders, self._topics.subscribers

    def advance(self) -> None:
        """Take one period with the voltage in force and publish the state at its end."""
        self._plant.advance(self._command.voltage, self._steps)
        self._command.elapse(self._period)
        self.publish_state()
        if self._standard is not None:
            self._standard.period_passed()

    def publish_state(self) -> None:
        """Publish the state as it is."""
        atmosphere = self._plant.parameters["atmospheric_pressure"]
        self._topics.publish(self._plant.state, atmosphere, self._time.stamp())

    def _on_command(self, voltage: float) -> None:
        self._command.offer(voltage)
        self._time.command_arrived()

    def _apply(self, changes: Mapping[str, Value]) -> None:
        plant_changes = plant_values(changes, self._parts)
        if plant_changes:
            self._plant.set_parameters(plant_changes)
        if "internal_leakage" in plant_changes:
            self._topics.publish_leakage(plant_changes["internal_leakage"])
        self._command.limit = changes.get("command_limit", self._command.limit)
        self._command.timeout = changes.get("command_timeout", self._command.timeout)
        if "real_time_factor" in changes:
            self._time.set_factor(changes["real_time_factor"])

    def _on_pause(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        self._time.pause() if request.data else self._time.resume()
        response.success = True
        response.message = f"{'paused' if request.data else 'running'} at {self.elapsed / NANOSECONDS:.4f} s"
        return response

    def _on_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self.reset_plant()
        response.success = True
        response.message = f"back to the initial state at {self.elapsed / NANOSECONDS:.4f} s"
        return response

    def reset_plant(self) -> None:
        """Put the plant back to rest, its command to zero; time goes on."""
        self._earlier_steps += self._plant.step_count
        self._plant.reset()
        self._command.release()

    def reset_time(self) -> None:
        """Set simulated time back to zero."""
        self._earlier_steps = -self._plant.step_count

    def _on_step(self, request: Step.Request, response: Step.Response) -> Step.Response:
        try:
            response.message, to_come = self._time.step(request.steps)
            response.success = True
            response.time = (self.elapsed + to_come * self._step_ns) / NANOSECONDS
        except EhaError as error:
            response.message = str(error)
            response.time = self.elapsed / NANOSECONDS
        return response

    def step_plant(self, steps: int) -> None:
        """Take so many plant steps with the voltage in force and publish the state at their end."""
        for taken in range(0, steps, _SLICE):
            self._plant.advance(self._command.voltage, min(steps - taken, _SLICE))
        self.publish_state()

    def _report(self) -> Report:
        command, troubles = self._command, []
        refused, clamped = command.refused - self._reported[0], command.clamped - self._reported[1]
        self._reported = (command.refused, command.clamped)
        if refused:
            troubles.append(f"{refused} commands refused: not a finite number")
        if clamped:
            troubles.append(f"{clamped} commands clamped to {command.limit:g} V")
        if command.timeouts and not command.holds:
            troubles.append(f"no command for {command.timeout:g} s: the voltage is zero")
        troubles += self._commander_troubles() + self._topics.troubles()
        values = {
            "simulated_time": self.elapsed / NANOSECONDS,
            "voltage": command.voltage,
            "commands_accepted": command.accepted,
            "commands_refused": command.refused,
            "commands_clamped": command.clamped,
            "command_timeouts": command.timeouts,
        }
        time_values, time_troubles = self._time.report()
        return Report({**values, **time_values}, troubles + time_troubles)

    def _commander_troubles(self) -> list[str]:
        """What is wrong with those who command; the log says it once."""
        troubles = self._commands.troubles()
        for trouble in set(troubles) - self._told:
            self.get_logger().warning(trouble)
        self._told = set(troubles)
        return troubles


def _steps_per_period(step_size: float, rate: float) -> int:
    steps = round(1.0 / (rate * step_size))
    if steps < 1 or abs(steps * rate * step_size - 1.0) > 1e-9:
        raise ParameterError(
            f"publish_rate = {rate:g} Hz is no whole number of steps of {step_size:g} s; change either"
        )
    return steps


def _clock_period(own: Mapping[str, Value]) -> int:
    """Simulated time from one /clock to the next [ns]; 0: with every state."""
    if not own["clock_rate"]:
        return 0
    periods = own["publish_rate"] / own["clock_rate"]
    if periods < 1 or abs(periods - round(periods)) > 1e-9:
        raise ParameterError(
            f"clock_rate = {own['clock_rate']:g} Hz does not divide publish_rate = {own['publish_rate']:g} Hz"
        )
    return round(NANOSECONDS / own["clock_rate"])


def main() -> int:
    """Run the simulator node."""
    return run(SimNode, NAME, OWN_ROWS, compile_plant)


if __name__ == "__main__":
    sys.exit(main())
