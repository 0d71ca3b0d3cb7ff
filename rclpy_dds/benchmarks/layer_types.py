"""Three of ROS 2's messages as plain Cyclone DDS types, whose annotations must be types and not text at run time."""

from dataclasses import dataclass

from cyclonedds.idl import IdlStruct, types


@dataclass
class Time(IdlStruct):
    """builtin_interfaces/msg/Time."""

    sec: types.int32
    nanosec: types.uint32


@dataclass
class Header(IdlStruct):
    """std_msgs/msg/Header."""

    stamp: Time
    frame_id: str


@dataclass
class Float64(IdlStruct):
    """std_msgs/msg/Float64."""

    data: types.float64


@dataclass
class JointState(IdlStruct):
    """sensor_msgs/msg/JointState."""

    header: Header
    name: types.sequence[str]
    position: types.sequence[types.float64]
    velocity: types.sequence[types.float64]
    effort: types.sequence[types.float64]


@dataclass
class Image(IdlStruct):
    """sensor_msgs/msg/Image."""

    header: Header
    height: types.uint32
    width: types.uint32
    encoding: str
    is_bigendian: types.uint8
    step: types.uint32
    data: types.sequence[types.uint8]
