"""The findings of a diagnosis: locations, effects and laws, their probabilities, and the test that would decide."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Location:
    """A failure of the nominal equations: site, its share of the unexplained energy, the part of state space, and the
    intervals [s].

    `law_over`: the variable of a recovered law, where the share is that law's. `all_of_stretch`: `when` is a whole
    stretch of a longer record. `alone`: no other equation could be examined.
    """

    site: str
    share: float
    where: str
    when: tuple[tuple[float, float], ...]
    law_over: str = ""
    all_of_stretch: bool = False
    alone: bool = False


@dataclass(frozen=True)
class FittedParameter:
    """A nominal parameter after calibration, with its standard deviation; `changed` if it differs from its nominal
    value, `at_bound` if a prior bound limits it."""

    name: str
    nominal: float
    fitted: float
    std: float
    unit: str
    changed: bool
    note: str = ""
    at_bound: bool = False


@dataclass(frozen=True)
class FittedValue:
    """An effect's parameter with its standard deviation; `interval`: the ends of its 95 % interval where the standard
    deviation does not give them, None for an open end."""

    value: float
    std: float
    unit: str
    interval: tuple[float | None, float | None] | None = None


@dataclass(frozen=True)
class CommonScale:
    """A common factor that explains why several values differ from the nominal ones, such as a wrong clock.

    `of`: its likely cause; `parameters`: the names of the values that changed by it.
    """

    of: str
    factor: float
    std: float
    parameters: tuple[str, ...]


@dataclass(frozen=True)
class NamedEffect:
    """A physical effect that the recording shows.

    `evidence`: its gain in chi^2 minus the cost of its parameters; for one of several effects, the rise of chi^2
    without it. `active`: the interval in which it acts [s], None where it always does. `kind`: the kind of law, if the
    catalogue has several forms of it. `probability`: that of the name.
    """

    id: str
    site: str
    equation: str
    parameters: Mapping[str, FittedValue]
    evidence: float
    statement: str
    active: tuple[float, float] | None = None
    kind: str = ""
    probability: float = 1.0


@dataclass(frozen=True)
class ProbableSet:
    """A set of effects that may be missing, by their ids, and its probability."""

    effects: tuple[str, ...]
    probability: float


@dataclass(frozen=True)
class Alternative:
    """Effects that explain the recording about as well as the named ones; `evidence_gap`: how far they are behind."""

    effects: tuple[str, ...]
    evidence_gap: float


@dataclass(frozen=True)
class UnknownLaw:
    """A law outside the catalogue, recovered as a curve over one variable, and as an expression where it is simple.

    `function_of` names the variable and, after a comma, the curve's factor, if it has one. `r_squared` is the share of
    the model's excess error that it explains. `samples`: the curve, (variable, law) in SI.
    """

    site: str
    function_of: str
    expression: str
    r_squared: float
    samples: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Experiment:
    """A test for the rig whose outcome would distinguish the rivals, as parameters of the reference generator.

    `record`: channels that have to be recorded in addition, where no voltage alone would suffice. `duration` [s]: how
    long the test has to last. `reference` is empty where no test was found: `statement` then gives the reason and what
    to record. `expected`: chi^2 by which the outcome separates the two rivals that are hardest to distinguish.
    """

    statement: str
    separates: tuple[str, ...]
    reference: Mapping[str, object]
    record: tuple[str, ...] = ()
    duration: float = 10.0
    expected: float = 0.0
