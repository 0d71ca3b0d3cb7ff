"""Not offered by this layer."""

raise ImportError("rclpy_dds does not offer lifecycle nodes; install ROS 2 for them (https://docs.ros.org)")
