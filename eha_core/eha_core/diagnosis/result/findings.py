"""What a diagnosis finds: where, which effects and laws, how probable, and the test that would decide."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Location:
    """Where the nominal equations fail: site, its share of the unexplained energy, where in state space, and when
    [s].

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
    """A nominal parameter after calibration, with its standard deviation; `changed` if it left its nominal value,
    `at_bound` if the fit would have taken it further than it is believed to go."""

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
    """An effect's parameter with its standard deviation; `interval`: the ends of its 95 % interval where that is none
    of two standard deviations to either side, None for an end that the recording does not tell."""

    value: float
    std: float
    unit: str
    interval: tuple[float | None, float | None] | None = None


@dataclass(frozen=True)
class CommonScale:
    """One factor by which several values differ from the nominal ones, as if one thing were off that they share.

    `of` is what that may be; `parameters` are the names of those that changed by it.
    """

    of: str
    factor: float
    std: float
    parameters: tuple[str, ...]


@dataclass(frozen=True)
class NamedEffect:
    """A physical effect that the recording shows.

    `evidence` is what it gains in chi^2, less what its parameters cost; of one of several effects, what the fit would
    lose without it. `active` is the interval in which it acts [s], None where it always does; `kind` the kind of law
    that it is a form of, if the catalogue has several; `probability` that of the name.
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
    """A set of effects that may be what is missing, by their ids, and its probability."""

    effects: tuple[str, ...]
    probability: float


@dataclass(frozen=True)
class Alternative:
    """Effects that explain the recording as well as the named ones, but for `evidence_gap`."""

    effects: tuple[str, ...]
    evidence_gap: float


@dataclass(frozen=True)
class UnknownLaw:
    """A law outside the catalogue, recovered as a curve over one variable, and as an expression where it is simple.

    `function_of` names the variable, and after a comma what the curve is multiplied by, if it is. `r_squared` is the
    share that it explains of what the model lacks beyond noise. `samples`: the curve, (variable, law) in SI.
    """

    site: str
    function_of: str
    expression: str
    r_squared: float
    samples: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Experiment:
    """A test for the rig whose outcome would tell the rivals apart, as parameters of the reference generator.

    `record`: channels that have to be recorded beside those of the recording, where no voltage alone would tell.
    `duration` [s]: how long the test has to last. `reference` is empty where no such test was made: then `statement`
    says why, and what to record. `expected`: chi^2 by which its outcome separates the two rivals that are hardest to
    tell apart.
    """

    statement: str
    separates: tuple[str, ...]
    reference: Mapping[str, object]
    record: tuple[str, ...] = ()
    duration: float = 10.0
    expected: float = 0.0
