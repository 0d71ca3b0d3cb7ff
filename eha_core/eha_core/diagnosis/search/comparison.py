"""What a search hands on: the nominal model, the sets that come near the best, and what the search cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from eha_core.diagnosis.criteria import parameter_cost
from eha_core.diagnosis.effect_parameters import parameters_used
from eha_core.diagnosis.hypothesis import Hypothesis, Member
from eha_core.diagnosis.result import TraceStep
from eha_core.effects import Effect
from eha_core.identification.fit import Fit


@dataclass(frozen=True)
class Entry:
    """A hypothesis (no effect: the nominal model) with its fit. `score` is against the nominal model, in chi^2, its
    `cost` for parameters paid."""

    hypothesis: Hypothesis
    fit: Fit
    score: float
    cost: float = 0.0

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects, by id."""
        return self.hypothesis.effects

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of the effects, sorted."""
        return self.hypothesis.ids


@dataclass(frozen=True)
class ModelComparison:
    """The sets that were fitted to their end, the best first.

    Attributes:
        nominal: the nominal model, with score 0.
        entries: the best set and whatever comes near it.
        residual_variance: of the residual in units of the assumed noise, under the best model and never below one.
        site_gains: chi^2 that the effects of each site explain, as the quadratic models predict it.
        left_over: what one more effect together with the best is predicted to gain, the most of each site.
        smaller: fits of the best set without one of its members, by the set.
        gain_over_required: of each member of the best set, what it gains over what is required of it.
        trace: every fit of the search.
        begun_anew: whether it began anew over longer windows, because what short ones showed explained too little.
    """

    nominal: Entry
    entries: tuple[Entry, ...]
    residual_variance: float
    site_gains: Mapping[str, float] = field(default_factory=dict)
    left_over: Mapping[str, float] = field(default_factory=dict)
    smaller: Mapping[Hypothesis, Fit] = field(default_factory=dict)
    gain_over_required: Mapping[Member, float] = field(default_factory=dict)
    trace: tuple[TraceStep, ...] = ()
    begun_anew: bool = False


def residual_variance(fits: Sequence[Fit]) -> float:
    """Variance of the residual in units of the assumed noise, under the best model and never below one."""
    best = min(fits, key=lambda result: result.objective)
    return max(1.0, best.data / best.count)


def rank(nominal: Fit, found: Mapping[Hypothesis, Fit]) -> tuple[Entry, ...]:
    """Scores: the gain over the nominal model in units of the residual's variance, less the cost of its parameters."""
    variance = residual_variance([nominal, *found.values()])
    entries = []
    for hypothesis, result in found.items():
        cost = (parameters_used(result) - len(nominal.free)) * parameter_cost(result.count, variance)
        gain = (nominal.objective - result.objective) / variance
        entries.append(Entry(hypothesis, result, gain - cost, cost))
    return tuple(sorted(entries, key=lambda entry: -entry.score))


def bounded(entry: Entry) -> bool:
    """Whether one of the effects has all its sizes at a bound or at nothing: then it explains nothing of its own."""
    return any(_is_nothing(effect, entry.fit) for effect in entry.effects)


def _is_nothing(effect: Effect, result: Fit) -> bool:
    switches = [
        np.isclose(result.values[name], row.nominal, atol=1e-6 * abs(row.typical))
        for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)
        if row.switches
    ]
    return bool(switches) and all(switches)
