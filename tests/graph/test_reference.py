"""The reference generator: shapes against their formulas, changes while it runs, and the leakage-free response."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import Rig
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from eha_core.plant import Plant
from eha_sim_node.sample_count import SampleCount


def times_of(messages: list[JointState]) -> np.ndarray:
    return np.array([message.header.stamp.sec + message.header.stamp.nanosec * 1e-9 for message in messages])


def test_samples_that_a_late_timer_drops_are_counted_and_told() -> None:
    count = SampleCount(100.0)
    for tick in range(100):
        count.sample(10_000_000 * tick + 3_000_000 * (tick % 2))  # jitter within a period
    assert count.report() == ({"samples": 100, "missed": 0}, [])
    for tick in range(100, 200, 4):
        count.sample(10_000_000 * tick)
    values, troubles = count.report()
    assert values == {"samples": 125, "missed": 72}
    assert len(troubles) == 1 and troubles[0].startswith("74 % of the samples were not sent")
    assert count.report() == (values, [])
    count.sample(0)  # /clock was set back
    assert count.report() == ({"samples": 1, "missed": 0}, [])


def test_a_sine_of_position_with_its_velocity(rig: Rig) -> None:
    rig.start("reference", "mode:=position", "signal:=sine", "sine.amplitude:=0.02", "sine.frequency:=2.0")
    heard = rig.hear(JointState, "reference")
    rig.wait(lambda: len(heard) > 300, "samples")
    position = np.array([message.position[0] for message in heard])
    velocity = np.array([message.velocity[0] for message in heard])
    # Whatever the phase: x^2 + (v / w)^2 is the squared amplitude.
    radius = np.hypot(position, velocity / (2 * np.pi * 2.0))
    assert radius == pytest.approx(np.full(len(heard), 0.02), rel=1e-9)


def test_parameters_change_while_it_runs(rig: Rig) -> None:
    rig.start("reference", "mode:=voltage", "signal:=square", "square.amplitude:=0.1")
    volts = rig.hear(Float64, "voltage_command")
    rig.wait(lambda: len(volts) > 20, "samples")
    assert {abs(message.data) for message in volts} == {0.1}
    change = Parameter("square.amplitude", value=0.25).to_parameter_msg()
    assert rig.call(SetParameters, "eha_reference/set_parameters", parameters=[change]).results[0].successful
    rig.wait(lambda: abs(volts[-1].data) == 0.25, "the new amplitude", 5)
    change = Parameter("signal", value="spiral").to_parameter_msg()
    result = rig.call(SetParameters, "eha_reference/set_parameters", parameters=[change]).results[0]
    assert not result.successful and "spiral" in result.reason
    count = len(volts)
    rig.wait(lambda: len(volts) > count + 20, "the old signal going on", 5)


def test_the_leakage_free_response_is_that_of_the_plant(rig: Rig) -> None:
    rig.start_sim("time_mode:=lockstep", "start_paused:=true")
    rig.start("reference", "lockstep:=true", "signal:=sine", "sine.amplitude:=8.4e-3", "sine.frequency:=1.0",
              "leakage_free_response:=true")  # fmt: skip
    rig.node.destroy_publisher(rig.commands)
    rig.client_ready("eha_reference/reset")
    references = rig.hear(JointState, "reference")
    rig.spin(0.5)
    from eha_interfaces.srv import Step

    assert rig.call(Step, "eha_sim/step", steps=5000).success
    rig.wait(lambda: len(references) == 251, "half a second of references")
    times = times_of(references)
    assert times == pytest.approx(np.arange(251) * 0.002, abs=1e-12)
    plant, expected = Plant({"internal_leakage": 0.0}), [0.0]
    for tick in range(250):
        plant.advance(8.4e-3 * np.sin(2 * np.pi * tick * 0.002), 20)
        expected.append(plant.state.position)
    assert [message.position[0] for message in references] == pytest.approx(expected, abs=1e-12)


def test_in_lockstep_the_first_voltage_waits_for_all_who_are_to_hear_it(rig: Rig) -> None:
    rig.start_sim("time_mode:=lockstep")
    states = rig.hear(JointState, "joint_states")
    rig.start("reference", "lockstep:=true", "listeners:=2", "signal:=sine", "sine.amplitude:=0.05",
              "sine.frequency:=1.0", "duration:=0.4")  # fmt: skip
    rig.node.destroy_publisher(rig.commands)
    rig.wait(lambda: states and rig.node.count_publishers("voltage_command"), "the simulator's first tick")
    rig.spin(1.0)
    assert set(times_of(states)) == {0.0}
    volts = rig.hear(Float64, "voltage_command")
    rig.wait(lambda: len(volts) == 201, "the whole signal")
    expected = [*(0.05 * np.sin(2 * np.pi * np.arange(200) * 0.002)), 0.0]
    assert [message.data for message in volts] == pytest.approx(expected, abs=1e-12)
