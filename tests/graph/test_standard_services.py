"""simulation_interfaces on the simulator: states, resets and steps as that standard has them."""

from __future__ import annotations

import pytest
from conftest import Rig
from sensor_msgs.msg import JointState
from simulation_interfaces.msg import Result, SimulationState, SimulatorFeatures
from simulation_interfaces.srv import (
    GetSimulationState,
    GetSimulatorFeatures,
    ResetSimulation,
    SetSimulationState,
    StepSimulation,
)
from std_msgs.msg import Float64

from eha_interfaces.msg import ActuatorState

OK = Result.RESULT_OK
STOPPED, PLAYING, PAUSED = (
    SimulationState.STATE_STOPPED,
    SimulationState.STATE_PLAYING,
    SimulationState.STATE_PAUSED,
)


def state(rig: Rig) -> int:
    return rig.call(GetSimulationState, "eha_sim/get_simulation_state").state.state


def change(rig: Rig, wanted: int) -> int:
    request = SimulationState(state=wanted)
    return rig.call(SetSimulationState, "eha_sim/set_simulation_state", state=request).result.result


def features(rig: Rig) -> set[int]:
    return set(rig.call(GetSimulatorFeatures, "eha_sim/get_simulator_features").features.features)


def test_scaled_time_is_stopped_played_paused_stepped_and_set_back(rig: Rig) -> None:
    sim = rig.start_sim("time_mode:=scaled", "start_paused:=true", "command_timeout:=0.0")
    states = rig.hear(ActuatorState, "state")
    assert features(rig) >= {SimulatorFeatures.SIMULATION_RESET_TIME, SimulatorFeatures.STEP_SIMULATION_MULTIPLE}
    assert state(rig) == STOPPED
    assert change(rig, PLAYING) == OK and state(rig) == PLAYING
    rig.commands.publish(Float64(data=0.05))
    rig.wait(lambda: states and states[-1].position > 1e-3, "motion", 10)
    refused = rig.call(StepSimulation, "eha_sim/step_simulation", steps=1).result
    assert refused.result == Result.RESULT_OPERATION_FAILED and "pause it first" in refused.error_message
    assert change(rig, PAUSED) == OK and state(rig) == PAUSED
    assert change(rig, PAUSED) == SetSimulationState.Response.ALREADY_IN_TARGET_STATE
    rig.spin(0.2)
    count, before = len(states), states[-1].header.stamp
    assert rig.call(StepSimulation, "eha_sim/step_simulation", steps=5).result.result == OK
    rig.wait(lambda: len(states) == count + 5, "five periods", 5)
    after = states[-1].header.stamp
    assert (after.sec - before.sec) * 10**9 + after.nanosec - before.nanosec == 5 * 2_000_000
    assert rig.call(ResetSimulation, "eha_sim/reset_simulation", scope=0).result.result == OK
    assert rig.call(StepSimulation, "eha_sim/step_simulation", steps=1).result.result == OK
    rig.wait(lambda: len(states) == count + 6, "the period after the reset", 5)
    assert (states[-1].header.stamp.nanosec, states[-1].position, states[-1].voltage) == (2_000_000, 0.0, 0.0)
    assert change(rig, STOPPED) == OK and state(rig) == STOPPED
    assert change(rig, SimulationState.STATE_NO_WORLD) == Result.RESULT_FEATURE_UNSUPPORTED
    assert change(rig, SimulationState.STATE_QUITTING) == OK
    assert sim.wait(15) == 0


def test_the_wall_clock_is_not_set_back(rig: Rig) -> None:
    rig.start_sim()
    assert SimulatorFeatures.SIMULATION_RESET_TIME not in features(rig)
    for scope, expected in ((0, Result.RESULT_FEATURE_UNSUPPORTED), (ResetSimulation.Request.SCOPE_STATE, OK)):
        assert rig.call(ResetSimulation, "eha_sim/reset_simulation", scope=scope).result.result == expected


@pytest.mark.timeout(60)
def test_a_step_in_lockstep_is_answered_when_its_last_command_has_come(rig: Rig) -> None:
    rig.start_sim("time_mode:=lockstep", "start_paused:=true")
    ticks: list[int] = []

    def on_joint_states(message: JointState) -> None:
        ticks.append(message.header.stamp.nanosec)
        if len(ticks) < 8:
            rig.commands.publish(Float64(data=0.0))

    rig.node.create_subscription(JointState, "joint_states", on_joint_states, 10)
    client = rig.node.create_client(StepSimulation, "eha_sim/step_simulation")
    rig.wait(client.service_is_ready, "the service")
    future = client.call_async(StepSimulation.Request(steps=8))
    rig.wait(lambda: len(ticks) == 8, "seven periods and the eighth's tick")
    rig.spin(0.5)
    assert not future.done()
    rig.commands.publish(Float64(data=0.0))
    rig.wait(future.done, "the answer", 10)
    assert future.result().result.result == OK
    assert ticks[:8] == [2_000_000 * tick for tick in range(8)]
    assert state(rig) == PAUSED
