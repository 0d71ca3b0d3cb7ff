"""`ros2 interface`: message and service types."""
