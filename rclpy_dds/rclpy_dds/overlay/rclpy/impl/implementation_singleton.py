"""The names of rclpy's C extension that programs catch or compare with."""

from types import SimpleNamespace

from rclpy import exceptions
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.guard_condition import GuardCondition
from rclpy.qos import QoSProfile, qos_profile_default

rclpy_implementation = SimpleNamespace(
    ClockType=ClockType,
    Context=Context,
    GuardCondition=GuardCondition,
    InvalidHandle=exceptions.InvalidHandle,
    NodeNameNonExistentError=exceptions.NodeNameNonExistentError,
    RCLError=exceptions.RCLError,
    RCLInvalidROSArgsError=exceptions.RCLInvalidROSArgsError,
    TimerCancelledError=exceptions.TimerCancelledError,
    UnknownROSArgsError=exceptions.UnknownROSArgsError,
    UnsupportedEventTypeError=exceptions.UnsupportedEventTypeError,
    rmw_qos_profile_t=SimpleNamespace(predefined=lambda _: qos_profile_default, QoSProfile=QoSProfile),
)
