"""The `ros2` command: one folder per command, one file per verb."""
