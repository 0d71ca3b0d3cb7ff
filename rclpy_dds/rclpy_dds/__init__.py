"""rclpy's API on Cyclone DDS: ROS 2 nodes in Python on machines without ROS 2."""
