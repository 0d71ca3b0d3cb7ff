"""What a recording or a planned test can detect: smallest sizes, and effects that cannot be distinguished."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Confusion:
    """Another effect that explains a response.

    `effect`: its id. `left`: chi^2 of the response at its detectable size that it does not explain; below TIE the two
    cannot be distinguished. `cosine`: of the angle between the two responses, orthogonalised against the fitted
    parameters; 1 where they are the same.
    """

    effect: str
    left: float
    cosine: float


@dataclass(frozen=True)
class Detectable:
    """An effect, or one of its independent sizes, and the smallest value of it that is found.

    Attributes:
        effect: its id. parameter: the size's short name. unit: of the values, SI.
        size: found with the stated probability, relative to the effect's neutral value; None where no size up to the
            catalogue's bound is found.
        share: of the response that fitted parameters cannot compensate. compensated_by: those that compensate most.
        shape: the effect's other values, by short name, at which this holds.
        typical: a usual size on a bench actuator.
        flow: of a leak, the flow that this size adds, root mean square [m^3/s]; else None.
        confusions: other effects that explain the response at this size about as well.
        with_pressures: of a planned test without pressures, the size if both are recorded, too.
    """

    effect: str
    parameter: str
    unit: str
    size: float | None
    share: float
    compensated_by: tuple[str, ...]
    shape: Mapping[str, float]
    typical: float
    flow: float | None = None
    confusions: tuple[Confusion, ...] = ()
    with_pressures: float | None = None


@dataclass(frozen=True)
class Noticeable:
    """A nominal parameter, and the smallest change from its nominal value that is reported; `flow`: of a leakage, the
    flow [m^3/s, root mean square] that this adds."""

    name: str
    unit: str
    nominal: float
    change: float
    flow: float | None = None


@dataclass(frozen=True)
class Undetected:
    """Upper limits of further effects and changes, beyond the fitted model.

    `power`: the probability with which each size would have been found. `effects`: those that were not named and are
    not rivals, in the catalogue's order. `parameters`: the nominal ones that have not changed.
    """

    power: float
    effects: tuple[Detectable, ...]
    parameters: tuple[Noticeable, ...]
