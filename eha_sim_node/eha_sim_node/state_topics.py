"""The simulator's topics: what a rig's sensors would say, and the model's truth beside it."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import Float64

from eha_core.plant import COLUMNS, Row
from eha_interfaces.msg import ActuatorState
from eha_sim_node.joints import JOINT
from eha_sim_node.serialised import Serialised

OUTPUT_QUALITY = QoSProfile(depth=500)
"""Reliable, a second of samples: what a recorder whose machine is busy may fall behind without loss. Best-effort
subscribers match it too."""

LATCHED = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)


class StateTopics:
    """Publishes one state of the plant on every topic.

    Args:
        node: the node that owns the publishers.
        frame_id: frame of every header.
        clock_period: simulated time from one /clock to the next [ns], 0: with every state; None: no /clock.
    """

    def __init__(self, node: Node, frame_id: str, clock_period: int | None) -> None:
        def publisher(message_type: Any, topic: str) -> Any:
            options = QoSOverridingOptions.with_default_policies()
            # a profile of its own for each: parameters may change it
            return node.create_publisher(message_type, topic, copy(OUTPUT_QUALITY), qos_overriding_options=options)

        self._node = node
        self._clock_period = clock_period or 0
        self._clock_publisher = publisher(Clock, "/clock") if clock_period is not None else None
        self._clock_stamp: int | None = None
        self._joint_publisher = publisher(JointState, "joint_states")
        self._pressure_a_publisher = publisher(FluidPressure, "chamber_a/pressure")
        self._pressure_b_publisher = publisher(FluidPressure, "chamber_b/pressure")
        self._state_publisher = publisher(ActuatorState, "state")
        self._leakage_publisher = node.create_publisher(Float64, "internal_leakage", LATCHED)
        clock = Clock()
        self._clock = Serialised(clock, clock.clock)
        self._joint, self._pressure, self._state = _joint(frame_id), _pressure(frame_id), _state(frame_id)
        self._leakage: float | None = None

    @property
    def subscribers(self) -> int:
        """How many subscribers are matched with the topics that tell of each period."""
        publishers = (
            self._clock_publisher,
            self._joint_publisher,
            self._pressure_a_publisher,
            self._pressure_b_publisher,
            self._state_publisher,
        )
        return sum(publisher.get_subscription_count() for publisher in publishers if publisher is not None)

    def publish(self, state: Row, atmospheric_pressure: float, stamp: int) -> None:
        """Publish a state that belongs to `stamp` [ns] where somebody hears it.

        joint_states comes last, for controllers answer that.
        """
        self._publish_clock(stamp)
        self.publish_leakage(state.internal_leakage)
        if self._pressure_a_publisher.get_subscription_count():
            absolute = state.measured_pressure_a + atmospheric_pressure
            self._pressure_a_publisher.publish(self._pressure.with_values(stamp, (absolute,)))
        if self._pressure_b_publisher.get_subscription_count():
            absolute = state.measured_pressure_b + atmospheric_pressure
            self._pressure_b_publisher.publish(self._pressure.with_values(stamp, (absolute,)))
        if self._state_publisher.get_subscription_count():
            self._state_publisher.publish(self._state.with_values(stamp, state))
        if self._joint_publisher.get_subscription_count():
            seen = state.measured_position, state.measured_velocity, state.hydraulic_force
            self._joint_publisher.publish(self._joint.with_values(stamp, seen))

    def _publish_clock(self, stamp: int) -> None:
        if self._clock_publisher is None:
            return
        # A state that is published again brings its /clock again, for the sake of whoever asks for it.
        last = self._clock_stamp
        if last is not None and 0 < stamp - last < self._clock_period:
            return
        self._clock_stamp = stamp
        self._clock_publisher.publish(self._clock.with_values(stamp))

    def troubles(self) -> list[str]:
        """Others that publish /clock beside this node: two clocks make every other node's time jump."""
        others = self._node.count_publishers("/clock") - 1 if self._clock_publisher is not None else 0
        return [f"{others} other publishers of /clock: time jumps between them; stop all but one"] if others > 0 else []

    def publish_leakage(self, coefficient: float) -> None:
        """Publish K_Lin [m^3/(s Pa)] if it is another than before."""
        if coefficient != self._leakage:
            self._leakage = coefficient
            self._leakage_publisher.publish(Float64(data=coefficient))


def _joint(frame_id: str) -> Serialised:
    message = JointState(name=[JOINT])
    message.header.frame_id = frame_id

    def put(numbers: Sequence[float]) -> None:
        message.position, message.velocity, message.effort = ([number] for number in numbers)

    return Serialised(message, message.header.stamp, put, 3)


def _pressure(frame_id: str) -> Serialised:
    message = FluidPressure()
    message.header.frame_id = frame_id

    def put(numbers: Sequence[float]) -> None:
        (message.fluid_pressure,) = numbers

    return Serialised(message, message.header.stamp, put, 1)


def _state(frame_id: str) -> Serialised:
    message = ActuatorState()
    message.header.frame_id = frame_id

    def put(numbers: Sequence[float]) -> None:
        for name, number in zip(COLUMNS, numbers, strict=True):
            setattr(message, name, number)

    return Serialised(message, message.header.stamp, put, len(COLUMNS))
