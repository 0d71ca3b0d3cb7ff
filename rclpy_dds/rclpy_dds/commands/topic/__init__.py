"""`ros2 topic`: topics."""
