"""The actuator's joint in messages that may carry several, in any order."""

from __future__ import annotations

from collections.abc import Sequence

JOINT = "piston"
"""Name of the piston rod's joint, in joint_states, joint_command and the robot's description."""


def value_of(names: Sequence[str], values: Sequence[float], joint: str = JOINT) -> float | None:
    """Return the joint's value, or None where a message does not name the joint or has no value for it."""
    for name, value in zip(names, values, strict=False):  # a JointState may leave position, velocity or effort out
        if name == joint:
            return float(value)
    return None
