"""The version of the actuator's packages; rclpy_dds has one of its own."""

__version__ = "0.2.0"
