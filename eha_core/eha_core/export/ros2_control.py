"""Gains for ros2_control's controllers, a parameters file in the form of `eha_description/config/controllers.yaml`."""

from __future__ import annotations

from collections.abc import Mapping

from eha_core.control.pid import CROSSOVER, RESET_TIME
from eha_core.control.position_gains import LARGEST_SENSITIVITY, position_gains

LARGEST_VOLTAGE = 10.0
"""V; what the drive takes, either sign: the controller node's `command_limit`."""

_TEXT = """\
{heading}
# Gains from the plant linearised about mid stroke, with the command's delay and no other effect:
# ff = 1 / velocity gain ({velocity_gain:.4g} m/s per V), p = crossover ff, i = p crossover / {resets:g}.
# The crossover is {crossover:.3g} rad/s; the peak of the sensitivity is {sensitivity:.2f}, at most {largest:g} allowed.
# Output: volts on the effort interface of the joint piston. Where the law of eha_controller runs in place of ff, set ff
# to 0.0.
/**/controller_manager:
  ros__parameters:
    update_rate: {rate}
    joint_trajectory_controller:
      type: joint_trajectory_controller/JointTrajectoryController
    pid_controller:
      type: pid_controller/PidController

/**/joint_trajectory_controller:
  ros__parameters:
    joints: [piston]
    command_interfaces: [effort]
    state_interfaces: [position, velocity]
    gains:
      piston:
        p: {p}  # V/m
        i: {i}  # V/(m s)
        d: 0.0  # V s/m
        ff_velocity_scale: {ff}  # V/(m/s)
        u_clamp_max: {volts}  # V
        u_clamp_min: -{volts}
        antiwindup_strategy: conditional_integration
    constraints:
      stopped_velocity_tolerance: 0.01
      goal_time: 1.0
      piston:
        goal: 0.0005

/**/pid_controller:
  ros__parameters:
    dof_names: [piston]
    command_interface: effort
    reference_and_state_interfaces: [position, velocity]
    enable_feedforward: true
    gains:
      piston:
        p: {p}
        i: {i}
        d: 0.0
        feedforward_gain: {ff}
        u_clamp_max: {volts}
        u_clamp_min: -{volts}
        antiwindup_strategy: conditional_integration
"""


def controllers_text(values: Mapping[str, float], rate: int, heading: str) -> str:
    """The file's text.

    Args:
        values: every parameter of the equations [SI].
        rate: the controller manager's update rate [Hz].
        heading: comment lines for the top of the file.

    Raises ParameterError where no gains make a sound loop; see `position_gains`.
    """
    gains = position_gains(values, 1.0 / rate)
    return _TEXT.format(
        heading=heading, rate=rate, velocity_gain=1.0 / gains.feedforward, crossover=gains.crossover,
        sensitivity=gains.sensitivity, largest=LARGEST_SENSITIVITY, resets=CROSSOVER * RESET_TIME,
        volts=LARGEST_VOLTAGE,
        p=f"{gains.proportional:#.6g}", i=f"{gains.integral:#.6g}", ff=f"{gains.feedforward:#.6g}",
    )  # fmt: skip
