"""`ros2 param`: parameters."""
