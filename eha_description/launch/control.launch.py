"""The simulator, ros2_control and a controller.

    ros2 launch eha_description control.launch.py controller:=pid_controller

Arguments: namespace, time_mode (realtime, scaled, lockstep), plant (a parameters file of the simulator), controller
(joint_trajectory_controller, pid_controller, cascade), controllers (a file with their gains, such as `eha export
controller` writes), hardware (joint_state, joint_command), record (true, false), directory. The simulator itself
publishes joint_states, which robot_state_publisher takes; no broadcaster is spawned.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xacro
from ament_index_python.packages import get_package_share_directory
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

CONTROLLERS = {
    "joint_trajectory_controller": ["joint_trajectory_controller"],
    "pid_controller": ["pid_controller"],
    "cascade": ["velocity_loop", "position_loop"],
}
ARGUMENTS = (
    DeclareLaunchArgument("namespace", default_value="", description="namespace of every node"),
    DeclareLaunchArgument("time_mode", default_value="realtime", choices=["realtime", "scaled", "lockstep"]),
    DeclareLaunchArgument("plant", default_value="", description="parameters file of the simulator, e.g. fitted.yaml"),
    DeclareLaunchArgument("controller", default_value="joint_trajectory_controller", choices=list(CONTROLLERS)),
    DeclareLaunchArgument("controllers", default_value="", description="file with the gains; empty: the package's own"),
    DeclareLaunchArgument("hardware", default_value="joint_state", choices=["joint_state", "joint_command"]),
    DeclareLaunchArgument("record", default_value="false", choices=["true", "false"]),
    DeclareLaunchArgument("directory", default_value="bags", description="folder that recordings go to"),
)


def generate_launch_description() -> LaunchDescription:
    """Return the arguments and what becomes of them."""
    return LaunchDescription([*ARGUMENTS, OpaqueFunction(function=nodes)])


def nodes(context: LaunchContext) -> list[Node]:
    """Return the nodes for the arguments given."""
    given = {item.name: LaunchConfiguration(item.name).perform(context) for item in ARGUMENTS}
    share = Path(get_package_share_directory("eha_description"))
    namespace = given["namespace"].strip("/")
    controllers = given["controllers"] or str(share / "config" / "controllers.yaml")
    clock = {"use_sim_time": given["time_mode"] != "realtime"}
    description = {"robot_description": robot_description(share, f"/{namespace}".rstrip("/"), given["hardware"])}
    simulator: list[Any] = [str(share / "config" / "simulator.yaml"), {"time_mode": given["time_mode"]}]
    simulator += [given["plant"]] if given["plant"] else []
    started = [
        Node(package="eha_sim_node", executable="sim", name="eha_sim", namespace=namespace, parameters=simulator),
        Node(package="robot_state_publisher", executable="robot_state_publisher", namespace=namespace,
             parameters=[description, clock]),
        Node(package="controller_manager", executable="ros2_control_node", namespace=namespace,
             parameters=[controllers, clock], output="screen"),
        Node(package="controller_manager", executable="spawner", namespace=namespace,
             arguments=[*CONTROLLERS[given["controller"]], "--param-file", controllers, "--activate-as-group"]),
    ]  # fmt: skip
    if given["record"] == "true":
        recorder = {"directory": given["directory"], **clock}
        started.append(Node(package="eha_sim_node", executable="monitor", name="eha_monitor", namespace=namespace,
                            parameters=[recorder]))  # fmt: skip
    return started


def robot_description(share: Path, prefix: str, hardware: str) -> str:
    """Return the URDF, with the topics of the namespace `prefix` ("" or "/name")."""
    topics = {"joint_commands_topic": f"{prefix}/joint_command", "joint_states_topic": f"{prefix}/joint_states"}
    mappings = {"hardware": hardware, **topics}
    text: str = xacro.process_file(str(share / "urdf" / "actuator.urdf.xacro"), mappings=mappings).toxml()
    return text
