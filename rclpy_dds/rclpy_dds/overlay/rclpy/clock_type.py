"""Which clock a time is of."""

from enum import IntEnum


class ClockType(IntEnum):
    """The clocks of ROS: ROS_TIME follows /clock where use_sim_time says so."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3
