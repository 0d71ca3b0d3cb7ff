"""What a signal is: a frozen set of described parameters, a value at every time, and the value's derivative."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import MISSING, dataclass, field, fields
from math import inf, isfinite
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eha_core.errors import ParameterError

FloatArray = NDArray[np.float64]
Value = float | int | bool | str

EDGE = 1e-9
"""A switching instant counts as reached this part of a dwell early, so that rounded sample times fall on it."""


def described(default: Value, meaning: str, unit: str = "", lower: float = -inf, upper: float = inf) -> Any:
    """A dataclass field that carries what a user needs to know; `unit` "same" is the signal's own, V or m."""
    return field(default=default, metadata={"meaning": meaning, "unit": unit, "lower": lower, "upper": upper})


@dataclass(frozen=True)
class SignalParameter:
    """One parameter of a signal: its default, whose type is the parameter's, its meaning, unit and bounds."""

    name: str
    default: Value
    meaning: str
    unit: str
    lower: float
    upper: float

    def check(self, value: Any, where: str) -> Value:
        """Return the value in the parameter's type, or raise ParameterError naming what is allowed."""
        kind = type(self.default)
        try:
            converted: Value = _TRUTH[str(value).lower()] if kind is bool else kind(value)
        except (KeyError, TypeError, ValueError):
            raise ParameterError(f"{where}{self.name} = {value!r} is no {_KINDS[kind]}; it is {self.meaning}") from None
        if isinstance(converted, (bool, str)):
            return converted
        if not isfinite(converted) or not self.lower <= converted <= self.upper:
            unit = f" {self.unit}" if self.unit not in ("", "same") else ""
            raise ParameterError(
                f"{where}{self.name} = {converted:g} is out of range; give {self.lower:g} to {self.upper:g}{unit}"
            )
        return converted


_KINDS: dict[type, str] = {float: "number", int: "whole number", bool: "truth value", str: "text"}
_TRUTH = {"true": True, "1": True, "yes": True, "false": False, "0": False, "no": False}


@dataclass(frozen=True)
class Signal(ABC):
    """A voltage [V] or a position [m] over time; before time 0 it holds what it is at 0.

    A subclass is the one signal of its file and bears the file's name. Its fields are made by `described`; the values
    are checked on construction, which raises ParameterError.
    """

    offset: float = described(0.0, "added to the whole signal", "same")

    name: ClassVar[str]

    def __init_subclass__(cls) -> None:
        """Name the signal after its file."""
        cls.name = cls.__module__.rpartition(".")[2]

    def __post_init__(self) -> None:
        """Check every parameter and what they mean together."""
        for row in self.parameters():
            object.__setattr__(self, row.name, row.check(getattr(self, row.name), f"{self.name}."))
        self.check_together()

    @classmethod
    def parameters(cls) -> tuple[SignalParameter, ...]:
        """The described parameters, in the order of the file."""
        rows = [
            SignalParameter(row.name, row.default, **row.metadata) for row in fields(cls) if row.default is not MISSING
        ]
        return (*rows[1:], rows[0])

    def check_together(self) -> None:  # noqa: B027 - a hook that may stay empty
        """Raise ParameterError where parameters do not fit each other; most signals have nothing to check."""

    def value(self, time: ArrayLike) -> Any:
        """The signal at `time` [s]: a float for a number, an array of the same shape for an array."""
        return self._evaluate(self.shape, time, self.offset)

    def derivative(self, time: ArrayLike) -> Any:
        """The signal's rate at `time` [1/s], as `value`; zero at jumps, and before time 0."""
        return self._evaluate(lambda seconds: np.where(np.asarray(time) < 0.0, 0.0, self.slope(seconds)), time, 0.0)

    @staticmethod
    def _evaluate(law: Any, time: ArrayLike, offset: float) -> Any:
        seconds = np.maximum(np.asarray(time, dtype=np.float64), 0.0)
        values = offset + law(seconds)
        return float(values) if seconds.ndim == 0 else values

    @abstractmethod
    def shape(self, time: FloatArray) -> FloatArray:
        """The signal without its offset, at times from 0 on [s]."""

    def slope(self, time: FloatArray) -> FloatArray:
        """The shape's rate at times from 0 on [s]; zero for the signals that only jump."""
        return np.zeros_like(time)


def ticks(time: FloatArray, dwell: float) -> NDArray[np.int64]:
    """How many dwells are over at `time`."""
    return np.floor(time / dwell + EDGE).astype(np.int64)
