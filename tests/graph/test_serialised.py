"""Bytes written in place are those that serialising the whole message gives."""

from __future__ import annotations

import math

import pytest
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import FluidPressure, JointState

from eha_core.plant import COLUMNS
from eha_interfaces.msg import ActuatorState
from eha_sim_node import state_topics
from eha_sim_node.serialised import Serialised
from eha_sim_node.stamps import set_stamp

STAMPS = (0, 1_795_346_348_118_366_322, 999_999_999, 1_000_000_000)
NUMBERS = (0.0, -0.0, -1.5e-300, math.pi, math.inf, 1.7e308)


def joint(stamp: int, numbers: list[float], frame: str) -> JointState:
    position, velocity, effort = numbers
    message = JointState(name=["piston"], position=[position], velocity=[velocity], effort=[effort])
    return stamped(message, stamp, frame)


def pressure(stamp: int, numbers: list[float], frame: str) -> FluidPressure:
    return stamped(FluidPressure(fluid_pressure=numbers[0]), stamp, frame)


def state(stamp: int, numbers: list[float], frame: str) -> ActuatorState:
    return stamped(ActuatorState(**dict(zip(COLUMNS, numbers, strict=True))), stamp, frame)


def stamped(message, stamp: int, frame: str):
    set_stamp(message.header.stamp, stamp)
    message.header.frame_id = frame
    return message


@pytest.mark.parametrize("frame", ["", "a", "ab", "abc", "a frame of more than eight letters"])
@pytest.mark.parametrize(
    ("made", "whole", "count"),
    [(state_topics._joint, joint, 3), (state_topics._pressure, pressure, 1), (state_topics._state, state, 22)],
)
def test_a_message_written_in_place_is_the_message(made, whole, count: int, frame: str) -> None:
    serialised = made(frame)
    for turn, stamp in enumerate(STAMPS):
        numbers = [NUMBERS[(turn + k) % len(NUMBERS)] + k for k in range(count)]
        expected = whole(stamp, numbers, frame)
        found = serialised.with_values(stamp, numbers)
        assert found == serialize_message(expected)
        assert deserialize_message(found, type(expected)) == expected


def test_a_number_that_does_not_stand_in_the_message_is_refused() -> None:
    message = FluidPressure()
    with pytest.raises(ValueError, match="does not stand once"):
        Serialised(message, message.header.stamp, lambda numbers: None, 1)
