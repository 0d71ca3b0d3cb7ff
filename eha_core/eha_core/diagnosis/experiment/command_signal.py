"""A voltage that a test may have, by a signal's name and parameters, as the reference node takes them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eha_core.identification.numbers import Array
from eha_core.quantities import quantity
from eha_core.signals import make_signal, of_reference, signals


@dataclass(frozen=True)
class CommandSignal:
    """A signal for the reference generator, by name and parameters."""

    signal: str
    parameters: Mapping[str, float | str | bool]

    @classmethod
    def of(cls, reference: Mapping[str, object]) -> CommandSignal:
        """The signal that the reference node's parameters name."""
        return cls(*of_reference(reference))  # type: ignore[arg-type]

    def reference(self) -> dict[str, object]:
        """As the reference node's parameters."""
        return {
            "mode": "voltage",
            "signal": self.signal,
            **{f"{self.signal}.{k}": v for k, v in self.parameters.items()},
        }

    def settings(self) -> str:
        """Its parameters in words: "amplitude 0.45 V, frequency 2 Hz"."""
        units = {row.name: row.unit.replace("same", "V") for row in signals()[self.signal].parameters()}
        shown = {
            name.replace("_", " "): quantity(value, units[name]) if isinstance(value, float) else value
            for name, value in self.parameters.items()
        }
        return ", ".join(f"{name} {value}" for name, value in shown.items())

    def voltage(self, times: Array) -> Array:
        """Its voltage [V] at these times [s]."""
        return np.asarray(make_signal(self.signal, dict(self.parameters)).value(times))
