"""The simulator's services in ROS's common form, simulation_interfaces, beside its own ~/pause, ~/reset and ~/step.

What does not map is not offered: there is one rig that cannot be spawned, and no world to load. A step of the standard
is one period of the published state, the simulation's loop; `~/step` counts the plant's steps.
Source: github.com/ros-simulation/simulation_interfaces, version 2.1.0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.task import Future

from eha_sim_node.time_modes import TimeMode

try:
    from simulation_interfaces.msg import Result, SimulationState, SimulatorFeatures
    from simulation_interfaces.srv import (
        GetSimulationState,
        GetSimulatorFeatures,
        ResetSimulation,
        SetSimulationState,
        StepSimulation,
    )
except ImportError:  # a ROS 2 without that package
    Result = None

if TYPE_CHECKING:
    from eha_sim_node.sim import SimNode

LARGEST_STEPS = 1_000_000
"""Periods that one request may ask for: more would keep the node from answering for minutes."""

_GOODBYE = 0.2  # s from the answer to the end, for the answer to get out


class StandardServices:
    """GetSimulatorFeatures, Get- and SetSimulationState, ResetSimulation and StepSimulation of one simulator node."""

    def __init__(self, node: SimNode, time: TimeMode) -> None:
        self._node = node
        self._time = time
        self._stopped_at = node.elapsed if time.paused else None
        self._stepping: Future | None = None
        for service, name, serve in (
            (GetSimulatorFeatures, "get_simulator_features", self._features),
            (GetSimulationState, "get_simulation_state", self._get_state),
            (SetSimulationState, "set_simulation_state", self._set_state),
            (ResetSimulation, "reset_simulation", self._reset),
        ):
            node.create_service(service, f"~/{name}", serve)
        # A group of its own: while a request waits for its steps, the commands that make them must be served.
        group = MutuallyExclusiveCallbackGroup()
        node.create_service(StepSimulation, "~/step_simulation", self._step, callback_group=group)

    @staticmethod
    def available() -> bool:
        """Whether the package simulation_interfaces is installed."""
        return Result is not None

    def period_passed(self) -> None:
        """Note that a period was taken; a request that waits for the last of its steps is answered."""
        if self._stepping is not None and self._time.paused:
            self._stepping.set_result(None)
            self._stepping = None

    def _features(self, request: Any, response: Any) -> Any:
        known = SimulatorFeatures
        features = [
            known.SIMULATION_RESET, known.SIMULATION_RESET_STATE, known.SIMULATION_STATE_GETTING,
            known.SIMULATION_STATE_SETTING, known.SIMULATION_STATE_PAUSE, known.STEP_SIMULATION_SINGLE,
            known.STEP_SIMULATION_MULTIPLE,
        ]  # fmt: skip
        response.features.features = features + ([known.SIMULATION_RESET_TIME] if self._time.owned else [])
        response.features.custom_info = "electro-hydraulic actuator; a step is one period of the published state"
        return response

    def _state(self) -> int:
        if not self._time.paused:
            return int(SimulationState.STATE_PLAYING)
        stopped = self._stopped_at == self._node.elapsed
        return int(SimulationState.STATE_STOPPED if stopped else SimulationState.STATE_PAUSED)

    def _get_state(self, request: Any, response: Any) -> Any:
        response.state.state = self._state()
        response.result.result = Result.RESULT_OK
        return response

    def _set_state(self, request: Any, response: Any) -> Any:
        wanted, known = request.state.state, SimulationState
        response.result.result = Result.RESULT_OK
        if wanted == self._state():
            response.result.result = SetSimulationState.Response.ALREADY_IN_TARGET_STATE
        elif wanted == known.STATE_PLAYING:
            self._time.resume()
        elif wanted == known.STATE_PAUSED:
            self._time.pause()
            self._stopped_at = None
        elif wanted == known.STATE_STOPPED:
            self._stop()
        elif wanted == known.STATE_QUITTING:
            self._stop()
            self._node.create_timer(_GOODBYE, rclpy.try_shutdown)
        else:
            _refuse(response.result, Result.RESULT_FEATURE_UNSUPPORTED, f"state {wanted}: there is no world to load")
        return response

    def _stop(self) -> None:
        self._time.pause()
        self._node.reset_plant()
        if self._time.owned:
            self._node.reset_time()
        self._stopped_at = self._node.elapsed

    def _reset(self, request: Any, response: Any) -> Any:
        scope = request.scope or ResetSimulation.Request.SCOPE_ALL
        of_time = scope & ResetSimulation.Request.SCOPE_TIME
        if of_time and not self._time.owned:
            _refuse(
                response.result,
                Result.RESULT_FEATURE_UNSUPPORTED,
                "time is the wall clock's in time_mode realtime; ask for SCOPE_STATE",
            )
            return response
        if scope & ResetSimulation.Request.SCOPE_STATE:
            self._node.reset_plant()
        if of_time:
            self._node.reset_time()
        response.result.result = Result.RESULT_OK
        return response

    async def _step(self, request: Any, response: Any) -> Any:
        """Answer when the last step is taken, which in lockstep is when its command has come."""
        if not self._time.paused or self._stepping is not None:
            _refuse(response.result, Result.RESULT_OPERATION_FAILED, "the simulator is running; pause it first")
        elif not 1 <= request.steps <= LARGEST_STEPS:
            _refuse(response.result, Result.RESULT_OPERATION_FAILED, f"give 1 to {LARGEST_STEPS} steps")
        else:
            self._stopped_at = None
            done = self._stepping = Future()
            self._time.step_periods(request.steps)
            self.period_passed()
            await done
            response.result.result = Result.RESULT_OK
        return response


def _refuse(result: Any, code: int, reason: str) -> None:
    result.result, result.error_message = code, reason
