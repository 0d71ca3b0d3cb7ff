"""What departed, as a worker is given it, and what it finds: the single cause that explains it best."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from eha_core.twin.excerpt import Excerpt


@dataclass(frozen=True)
class Departure:
    """The seconds since something departs.

    Attributes:
        excerpt: them, and what coil and spool need before.
        parameters: the model's, by full name [SI].
        noises: standard deviation of the noise of each channel that can be compared [SI].
    """

    excerpt: Excerpt
    parameters: Mapping[str, float]
    noises: Mapping[str, float]


@dataclass(frozen=True)
class Size:
    """A fitted value, its standard deviation, and what it is in the model [SI]."""

    name: str
    value: float
    deviation: float
    modelled: float
    unit: str

    @property
    def change(self) -> float:
        """How far it is from the model's [SI]."""
        return self.value - self.modelled


@dataclass(frozen=True)
class Cause:
    """An effect, or a parameter of the model, that explains a departure.

    Attributes:
        name: the effect's id, or the parameter's name.
        sizes: the effect's sizes, or the parameter's value.
        flow: of a leak, by how much the flow through it differs from the model's, root mean square over the seconds at
            the pressures there, and its standard deviation [m^3/s].
    """

    name: str
    sizes: tuple[Size, ...]
    flow: tuple[float, float] | None = None


@dataclass(frozen=True)
class Explanation:
    """What a departure may come from.

    Attributes:
        seconds: how much of it was compared [s].
        cause: what explains it best; None where nothing explains most of it.
        rivals: what cannot be distinguished from the cause, the best first.
        residual: RMS of what the cause leaves, in units of the noise.
    """

    seconds: float
    cause: Cause | None
    rivals: tuple[Cause, ...] = ()
    residual: float = 1.0
