"""A hypothesis: the effects and recovered laws that a model adds to the nominal equations.

It is a value: two hypotheses with the same members are equal, wherever they come from, so that fits of one replace each
other and its scores add up over recordings.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from eha_core.diagnosis.criteria import LAW_SIZE
from eha_core.effects import Effect
from eha_core.identification.fit import Fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.per_recording import base_name, is_one_of
from eha_core.parameters import NOMINAL, acting_rows


@dataclass(frozen=True, order=True)
class Member:
    """One effect of a hypothesis, by its id.

    `limited`: it acts in an interval only, which is fitted; `variable`: that of a recovered law's curve, else empty.
    """

    id: str
    limited: bool = False
    variable: str = ""
    effect: Effect = field(compare=False, kw_only=True)

    @property
    def size(self) -> int:
        """The members that it counts as: 1, one more with a fitted interval, or LAW_SIZE for a recovered law."""
        return LAW_SIZE if self.variable else 1 + self.limited

    def span(self, values: Mapping[str, float]) -> tuple[float, float] | None:
        """Its active interval [s] in a model with these values; None where it always acts."""
        if not self.limited:
            return None
        begin, end = (values[name] for name in self.effect.acting_names())
        return begin, end


@dataclass(frozen=True)
class Hypothesis:
    """A set of effects, each acting always or in an interval, and of recovered laws."""

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
        """The sum of its members' sizes."""
        return sum(member.size for member in self.members)

    @property
    def law(self) -> Member | None:
        """Its recovered law; None without one."""
        return next((member for member in self.members if member.variable), None)

    @property
    def limited(self) -> tuple[Member, ...]:
        """The members that act in an interval only."""
        return tuple(member for member in self.members if member.limited)

    @property
    def kinds(self) -> frozenset[str]:
        """The kinds of law of which it contains a form."""
        return frozenset(effect.kind for effect in self.effects if effect.kind)

    def admits(self, effect: Effect) -> bool:
        """Whether an effect can be added: neither it nor another form of its law is a member."""
        return effect.id not in self.ids and effect.kind not in self.kinds

    def with_effects(self, effects: Iterable[Effect], limited: bool = False, variable: str = "") -> Hypothesis:
        """The set with more effects in it."""
        more = (Member(effect.id, limited, variable, effect=effect) for effect in effects)
        return Hypothesis(tuple(sorted({*self.members, *more})))

    def without(self, member: Member) -> Hypothesis:
        """The set without one of its members."""
        return Hypothesis(tuple(other for other in self.members if other != member))

    def holds(self, other: Hypothesis) -> bool:
        """Whether it contains every member of another."""
        return set(other.members) <= set(self.members)


NOTHING = Hypothesis()
"""The nominal equations alone."""


def neutral(effect: Effect) -> Mapping[str, float]:
    """The values (full names) at which an effect is off and its interval unlimited."""
    off = {name: row.nominal for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)}
    return off | {name: row.nominal for name, row in acting_rows(effect).items()}


NOMINAL_NAMES = frozenset(row.name for row in NOMINAL)
"""The names of the nominal plant's own parameters."""


def without_effect(result: Fit, effect: Effect) -> tuple[dict[str, float], tuple[FreeParameter, ...]]:
    """A fit's values with one effect off, and the parameters that remain free."""
    off = neutral(effect)
    values = {name: off.get(base_name(name), value) for name, value in result.values.items()}
    return values, tuple(parameter for parameter in result.free if not is_one_of(parameter.name, off))
