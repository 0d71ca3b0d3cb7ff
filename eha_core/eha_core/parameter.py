"""One parameter of the actuator: a frozen row of what it is, in which unit, how far it may go and who says so."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from eha_core.errors import ParameterError


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A physical quantity that the plant is built from.

    `typical` is a size at which the quantity matters on a bench actuator: where a search for it starts, and what the
    catalogue's own tests plant. It is the nominal value itself for the parameters of the nominal plant.
    A search tries each of `starts`, in units of the observed quantity that `relative_to` names (one of
    `eha_core.diagnosis.characteristic_scales.QUANTITIES`), or of `typical` where it names none. `above` names a
    parameter of the same effect that a fit takes this one never to be smaller than. `switches` marks the
    parameters that turn an effect on by leaving their nominal value. `replaces` names a parameter of the plant in whose
    place this one comes: with the same value it changes nothing. `logarithmic` says that a fit moves the quantity
    by factors; it can then not reach zero.
    """

    name: str
    symbol: str
    unit: str
    nominal: float
    lower: float
    upper: float
    meaning: str
    source: str
    typical: float = 0.0
    logarithmic: bool = False
    switches: bool = False
    relative_to: str = ""
    above: str = ""
    replaces: str = ""
    starts: tuple[float, ...] = (1.0,)

    def check(self, value: object, name: str | None = None) -> float:
        """Return `value` as a float, or raise ParameterError naming the parameter, the value and what is allowed."""
        name = name or self.name
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise ParameterError(f"{name} = {value!r} is not a number; give one in {self.unit}")
        number = float(value)
        if not isfinite(number):
            raise ParameterError(f"{name} = {number} is not finite; give {self.lower:g} to {self.upper:g} {self.unit}")
        if not self.lower <= number <= self.upper:
            raise ParameterError(
                f"{name} = {number:g} {self.unit} is out of range; give {self.lower:g} to {self.upper:g} {self.unit}"
            )
        return number
