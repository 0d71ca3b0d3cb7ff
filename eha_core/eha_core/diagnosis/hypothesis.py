"""A hypothesis: the effects, named ones and laws in no catalogue, that a model holds beyond the nominal equations.

It is a value, and the same hypothesis wherever it comes from: fits of it replace each other, scores of it add up over
recordings, and nothing else tells two hypotheses apart.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from eha_core.effects import Effect
from eha_core.identification.fit import Fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.per_recording import base_name, is_one_of
from eha_core.parameters import NOMINAL, acting_rows

LAW_SIZE = 3
"""Members that a law in no catalogue counts as, for its curve bends to whatever is there (assumed)."""


@dataclass(frozen=True, order=True)
class Member:
    """One effect of a hypothesis, by its id.

    `limited` where it acts in an interval only, which is then fitted; `variable`, of a law in no catalogue, what its
    curve is over.
    """

    id: str
    limited: bool = False
    variable: str = ""
    effect: Effect = field(compare=False, kw_only=True)

    @property
    def size(self) -> int:
        """What it counts as: 1, one more where its interval was chosen among all, or LAW_SIZE."""
        return LAW_SIZE if self.variable else 1 + self.limited

    def span(self, values: Mapping[str, float]) -> tuple[float, float] | None:
        """From when until when it acts [s] in a model of these values; None where it always does."""
        if not self.limited:
            return None
        begin, end = (values[name] for name in self.effect.acting_names())
        return begin, end


@dataclass(frozen=True)
class Hypothesis:
    """A set of effects, each acting always or in an interval, and of laws that are in no catalogue."""

    members: tuple[Member, ...] = ()

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects, by id."""
        return tuple(member.effect for member in self.members)

    @property
    def ids(self) -> tuple[str, ...]:
        """The effects' ids, sorted."""
        return tuple(member.id for member in self.members)

    @property
    def size(self) -> int:
        """What its members count as together."""
        return sum(member.size for member in self.members)

    @property
    def law(self) -> Member | None:
        """The law that is in no catalogue, if it holds one."""
        return next((member for member in self.members if member.variable), None)

    @property
    def limited(self) -> tuple[Member, ...]:
        """The members that act in an interval only."""
        return tuple(member for member in self.members if member.limited)

    @property
    def kinds(self) -> frozenset[str]:
        """The kinds of law that it holds a form of."""
        return frozenset(effect.kind for effect in self.effects if effect.kind)

    def admits(self, effect: Effect) -> bool:
        """Whether an effect can be added: not there yet, and no other form of a law that is."""
        return effect.id not in self.ids and effect.kind not in self.kinds

    def with_effects(self, effects: Iterable[Effect], limited: bool = False, variable: str = "") -> Hypothesis:
        """The set with more effects in it."""
        more = (Member(effect.id, limited, variable, effect=effect) for effect in effects)
        return Hypothesis(tuple(sorted({*self.members, *more})))

    def without(self, member: Member) -> Hypothesis:
        """The set without one of its members."""
        return Hypothesis(tuple(other for other in self.members if other != member))

    def holds(self, other: Hypothesis) -> bool:
        """Whether it says all that another says, or more."""
        return set(other.members) <= set(self.members)


NOTHING = Hypothesis()
"""The nominal equations alone."""


def neutral(effect: Effect) -> Mapping[str, float]:
    """The values (full names) at which an effect is off, and would always act."""
    off = {name: row.nominal for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)}
    return off | {name: row.nominal for name, row in acting_rows(effect).items()}


NOMINAL_NAMES = frozenset(row.name for row in NOMINAL)
"""The names of the nominal plant's own parameters."""


def without_effect(result: Fit, effect: Effect) -> tuple[dict[str, float], tuple[FreeParameter, ...]]:
    """A fit's values with one effect off, and what is then free."""
    off = neutral(effect)
    values = {name: off.get(base_name(name), value) for name, value in result.values.items()}
    return values, tuple(parameter for parameter in result.free if not is_one_of(parameter.name, off))
