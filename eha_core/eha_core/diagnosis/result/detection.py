"""What a recording, or a test that is planned, would have shown: smallest sizes, and what cannot be distinguished."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Confusion:
    """Another effect that explains a response.

    `effect`: its id. `left`: chi^2 that it leaves of the response at its detectable size; below TIE the two cannot be
    distinguished. `cosine`: of the angle between the two beside the fitted parameters, 1 where they are the same.
    """

    effect: str
    left: float
    cosine: float


@dataclass(frozen=True)
class Detectable:
    """An effect, or one of its independent sizes, and the smallest value of it that is found.

    Attributes:
        effect: its id. parameter: the size's short name. unit: of the values, SI.
        size: what is found with the stated probability, from where the effect is absent; None where no size up to the
            catalogue's bound is.
        share: of the response that fitted parameters cannot compensate. compensated_by: those that take most of it.
        shape: the effect's other values, by short name, at which this holds.
        typical: a size that is usual on a bench actuator.
        flow: of a leak, the flow that this size adds, root mean square [m^3/s]; None of anything else.
        confusions: other effects that explain the response at this size about as well.
        with_pressures: of a planned test without pressures, the size where both are recorded, too.
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
    """A nominal parameter, and by how much it must differ from its nominal value for the difference to be reported;
    `flow`: of a leakage, the flow [m^3/s, root mean square] that this adds."""

    name: str
    unit: str
    nominal: float
    change: float
    flow: float | None = None


@dataclass(frozen=True)
class Undetected:
    """What is not missing from the model that was found, or smaller than this.

    `power`: the probability with which each size would have been found. `effects`: those that were not named and are
    no rivals of what was, in the catalogue's order. `parameters`: the nominal ones that have not changed.
    """

    power: float
    effects: tuple[Detectable, ...]
    parameters: tuple[Noticeable, ...]
