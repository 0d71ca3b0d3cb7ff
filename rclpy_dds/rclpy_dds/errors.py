"""What a command of `ros2` could not do."""

from __future__ import annotations


class CommandError(Exception):
    """What a verb could not do; the message is the one line the user sees."""
