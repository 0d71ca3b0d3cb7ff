"""Run by a real rclpy: publishes what it hears on `there` again on `back`, and latches one message on `standing`."""

import contextlib
import sys

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState

if "rclpy_dds" in rclpy.__file__:
    sys.exit("this is not a real rclpy")
rclpy.init()
node = rclpy.create_node("real_peer")
back = node.create_publisher(JointState, "back", 100)
node.create_subscription(JointState, "there", back.publish, 100)
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
standing = node.create_publisher(JointState, "standing", latched)
standing.publish(JointState(name=["standing"], position=[0.25]))
print(rclpy.get_rmw_implementation_identifier(), flush=True)
with contextlib.suppress(KeyboardInterrupt):
    rclpy.spin(node)
