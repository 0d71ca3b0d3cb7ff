"""Points in time of a clock."""

from __future__ import annotations

from typing import Any

from builtin_interfaces.msg import Time as TimeMessage

from rclpy.clock_type import ClockType
from rclpy.constants import S_TO_NS
from rclpy.duration import Duration

_LIMIT = 2**63


class Time:
    """A point in time of one clock, in nanoseconds since its origin; never negative."""

    def __init__(
        self, *, seconds: float = 0, nanoseconds: float = 0, clock_type: ClockType = ClockType.SYSTEM_TIME
    ) -> None:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        if seconds < 0:
            raise ValueError("Seconds value must not be negative")
        if nanoseconds < 0:
            raise ValueError("Nanoseconds value must not be negative")
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if total >= _LIMIT:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")
        self._nanoseconds = total
        self._clock_type = clock_type

    @property
    def nanoseconds(self) -> int:
        """Return nanoseconds since the clock's origin."""
        return self._nanoseconds

    @property
    def clock_type(self) -> ClockType:
        """Return the clock this is a time of."""
        return self._clock_type

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Return whole seconds and the rest in nanoseconds."""
        return divmod(self._nanoseconds, S_TO_NS)

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self._nanoseconds}, clock_type={self._clock_type.name})"

    def __add__(self, other: object) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return Time(nanoseconds=self._nanoseconds + other.nanoseconds, clock_type=self._clock_type)
        except OverflowError as error:
            raise OverflowError("Addition leads to overflow in C storage.") from error

    __radd__ = __add__

    def __sub__(self, other: object) -> Any:
        if isinstance(other, Time):
            if self._clock_type != other._clock_type:
                raise TypeError("Can't subtract times with different clock types")
            return Duration(nanoseconds=self._nanoseconds - other._nanoseconds)
        if isinstance(other, Duration):
            try:
                return Time(nanoseconds=self._nanoseconds - other.nanoseconds, clock_type=self._clock_type)
            except ValueError as error:
                raise ValueError("Subtraction leads to negative time") from error
        return NotImplemented

    def _of_same_clock(self, other: object) -> Time | None:
        if not isinstance(other, Time):
            return None
        if self._clock_type != other._clock_type:
            raise TypeError("Can't compare times with different clock types")
        return other

    def __eq__(self, other: object) -> bool:
        same = self._of_same_clock(other)
        return NotImplemented if same is None else self._nanoseconds == same._nanoseconds

    def __ne__(self, other: object) -> bool:
        same = self._of_same_clock(other)
        return NotImplemented if same is None else self._nanoseconds != same._nanoseconds

    def __lt__(self, other: object) -> bool:
        same = self._of_same_clock(other)
        return NotImplemented if same is None else self._nanoseconds < same._nanoseconds

    def __le__(self, other: object) -> bool:
        same = self._of_same_clock(other)
        return NotImplemented if same is None else self._nanoseconds <= same._nanoseconds

    def __gt__(self, other: object) -> bool:
        same = self._of_same_clock(other)
        return NotImplemented if same is None else self._nanoseconds > same._nanoseconds

    def __ge__(self, other: object) -> bool:
        same = self._of_same_clock(other)
        return NotImplemented if same is None else self._nanoseconds >= same._nanoseconds

    def __hash__(self) -> int:
        return hash((self._nanoseconds, self._clock_type))

    def to_msg(self) -> Any:
        """Return the time as builtin_interfaces/msg/Time."""
        seconds, nanoseconds = divmod(self._nanoseconds, S_TO_NS)
        return TimeMessage(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any, clock_type: ClockType = ClockType.ROS_TIME) -> Time:
        """Return the time a builtin_interfaces/msg/Time holds."""
        if not isinstance(msg, TimeMessage):
            raise TypeError("Must pass a builtin_interfaces.msg.Time object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)
