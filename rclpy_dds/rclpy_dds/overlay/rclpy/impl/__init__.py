"""Parts of rclpy that other packages reach into by this path."""
