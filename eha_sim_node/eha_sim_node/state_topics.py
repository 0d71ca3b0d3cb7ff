"""The simulator's topics: what a rig's sensors would say, and the model's truth beside it."""

from __future__ import annotations

from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import Float64

from eha_core.plant import COLUMNS, State
from eha_interfaces.msg import ActuatorState
from eha_sim_node.stamps import set_stamp

OUTPUT_QUALITY = QoSProfile(depth=500)
"""Reliable, a second of samples: what a recorder whose machine is busy may fall behind without loss."""

LATCHED = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)


class StateTopics:
    """Publishes one state of the plant on every topic.

    Args:
        node: the node that owns the publishers.
        frame_id: frame of every header.
        owns_time: whether /clock is published too.
    """

    def __init__(self, node: Node, frame_id: str, owns_time: bool) -> None:
        self._clock_publisher = node.create_publisher(Clock, "/clock", OUTPUT_QUALITY) if owns_time else None
        self._joint_publisher = node.create_publisher(JointState, "joint_states", OUTPUT_QUALITY)
        self._pressure_a_publisher = node.create_publisher(FluidPressure, "chamber_a/pressure", OUTPUT_QUALITY)
        self._pressure_b_publisher = node.create_publisher(FluidPressure, "chamber_b/pressure", OUTPUT_QUALITY)
        self._state_publisher = node.create_publisher(ActuatorState, "state", OUTPUT_QUALITY)
        self._leakage_publisher = node.create_publisher(Float64, "internal_leakage", LATCHED)
        self._clock = Clock()
        self._joint = JointState(name=["piston"])
        self._pressure = FluidPressure()
        self._state = ActuatorState()
        for message in (self._joint, self._pressure, self._state):
            message.header.frame_id = frame_id
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

    def publish(self, state: State, atmospheric_pressure: float, stamp: int) -> None:
        """Publish a state that belongs to `stamp` [ns]; joint_states comes last, for controllers answer that."""
        if self._clock_publisher is not None:
            set_stamp(self._clock.clock, stamp)
            self._clock_publisher.publish(self._clock)
        self.publish_leakage(state.internal_leakage)
        pressure = self._pressure
        set_stamp(pressure.header.stamp, stamp)
        pressure.fluid_pressure = state.measured_pressure_a + atmospheric_pressure
        self._pressure_a_publisher.publish(pressure)
        pressure.fluid_pressure = state.measured_pressure_b + atmospheric_pressure
        self._pressure_b_publisher.publish(pressure)
        truth = self._state
        set_stamp(truth.header.stamp, stamp)
        for name, value in zip(COLUMNS, state, strict=True):
            setattr(truth, name, value)
        self._state_publisher.publish(truth)
        joint = self._joint
        set_stamp(joint.header.stamp, stamp)
        joint.position = [state.measured_position]
        joint.velocity = [state.measured_velocity]
        joint.effort = [state.hydraulic_force]
        self._joint_publisher.publish(joint)

    def publish_leakage(self, coefficient: float) -> None:
        """Publish K_Lin [m^3/(s Pa)] if it is another than before."""
        if coefficient != self._leakage:
            self._leakage = coefficient
            self._leakage_publisher.publish(Float64(data=coefficient))
