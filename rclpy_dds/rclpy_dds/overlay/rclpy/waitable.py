"""Not offered by this layer."""

raise ImportError("rclpy_dds does not offer custom waitables; install ROS 2 for them (https://docs.ros.org)")
