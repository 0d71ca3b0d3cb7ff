"""What was fitted: the best fit of each set, what it cost, and which step gained what."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf

import numpy as np

from eha_core.diagnosis.calibrate import corrected_noise, is_at_noise
from eha_core.diagnosis.criteria import (
    BLOCK,
    FAR_FROM_NOISE,
    REACH,
    SAME_NOISE,
    TO_THE_END,
    WHITE,
    chance_gain,
)
from eha_core.diagnosis.effect_parameters import free_instants, with_effects
from eha_core.diagnosis.hypothesis import NOTHING, Hypothesis
from eha_core.diagnosis.result import TraceStep
from eha_core.diagnosis.search.derivatives import Derivatives, derivatives
from eha_core.health.noise import block_means
from eha_core.identification.fit import Fit, fit, with_noise
from eha_core.identification.free_parameters import FreeParameter, not_believed
from eha_core.identification.numbers import Array
from eha_core.identification.per_recording import base_name, in_each
from eha_core.identification.problem import Problem
from eha_core.identification.shooting import Shooting
from eha_core.identification.short_windows import with_finer_slopes

Progress = Callable[[str], None]
"""Receives what is being tried."""


@dataclass
class Trace:
    """Every fit of a diagnosis, in order, and whether the search began anew over longer windows, because what short
    ones showed explains too little."""

    began: float = field(default_factory=time.process_time)
    steps: list[TraceStep] = field(default_factory=list)
    begun_anew: bool = False

    def add(self, step: str, hypothesis: Hypothesis, result: Fit) -> None:
        """Note a fit."""
        row = TraceStep(step, hypothesis.ids, result.data / max(result.count, 1), time.process_time() - self.began)
        self.steps.append(row)


@dataclass(frozen=True)
class _About:
    """Derivatives, and what they were computed for."""

    problem: Problem
    fit: Fit
    released: frozenset[str]
    derivatives: Derivatives


@dataclass
class Pool:
    """The best fit so far of each set over windows of one length.

    `believed`: the nominal parameters that are free, within the bounds of what is believed of them but for those
    `released`; `trace` is shared by the pools of all lengths; `filtered` are channels behind a filter, see
    `corrected_noise`; `settled` are the objectives of sets that were fitted to their end, `hopeless` those that were
    compared with a best set and did not come near it, `excessive` those of which a member was not needed.
    """

    problem: Problem
    believed: tuple[FreeParameter, ...]
    trace: Trace
    found: dict[Hypothesis, Fit] = field(default_factory=dict)
    filtered: frozenset[str] = frozenset()
    released: frozenset[str] = frozenset()
    settled: dict[Hypothesis, float] = field(default_factory=dict)
    hopeless: set[Hypothesis] = field(default_factory=set)
    excessive: set[Hypothesis] = field(default_factory=set)
    _about: _About | None = None

    @property
    def plant(self) -> tuple[FreeParameter, ...]:
        """The nominal parameters that are free, as they are now."""
        return without_bounds(self.believed, self.released, self.problem)

    def free(self, hypothesis: Hypothesis, values: Mapping[str, float]) -> tuple[FreeParameter, ...]:
        """What a fit of a set moves: the plant, its members, and between which instants limited ones act, about
        `values`."""
        free = with_effects(self.plant, hypothesis.effects, values)
        longest = float(np.max(self.problem.shooting.local_edges))
        for member in hypothesis.limited:
            span = {name: values[name] for name in member.effect.acting_names()}
            reach = [(max(at - REACH, 0.0), min(at + REACH, longest)) for at in span.values()]
            free = (*free, *free_instants(span, reach))
        return free

    def try_set(
        self, step: str, hypothesis: Hypothesis, values: Mapping[str, float], states: Array | None, iterations: int,
        free: Sequence[FreeParameter] | None = None, in_a_row: int = 1, give_up_above: float = inf,
    ) -> Fit:  # fmt: skip
        """Fit a set from values and states; keep it if it is the best fit of its set."""
        free = self.free(hypothesis, values) if free is None else free
        result = fit(
            self.posed(hypothesis), values, free, states,
            iterations=iterations, in_a_row=in_a_row, give_up_above=give_up_above,
        )  # fmt: skip
        self.trace.add(step, hypothesis, result)
        return self.keep(hypothesis, result)

    def glance(
        self, step: str, hypothesis: Hypothesis, values: Mapping[str, float], states: Array, iterations: int
    ) -> Fit:
        """A fit of the members' own parameters alone; it is not kept."""
        plant = {parameter.name for parameter in self.plant}
        free = tuple(parameter for parameter in self.free(hypothesis, values) if parameter.name not in plant)
        result = fit(self.problem, values, free, states, iterations=iterations)
        self.trace.add(step, hypothesis, result)
        return result

    def at_rest(self, hypothesis: Hypothesis, values: Mapping[str, float], states: Array) -> Fit:
        """A set as it stands at values and states, fitted to nothing; it is not kept."""
        return fit(self.posed(hypothesis), values, self.free(hypothesis, values), states, iterations=0)

    def fresh(self) -> Pool:
        """A pool of the same windows, noise and bounds that has no fits yet."""
        return replace(self, found={}, settled={}, hopeless=set(), excessive=set(), _about=None)

    def adopt(self, other: Pool) -> None:
        """Keep the fits of another pool of the same windows, in the noise of this one."""
        for hypothesis, result in other:
            self.keep(hypothesis, in_noise_of(self.problem, other.problem.shooting, result))

    def posed(self, hypothesis: Hypothesis) -> Problem:
        """The problem with derivatives taken as finely as the set needs."""
        return with_finer_slopes(self.problem) if hypothesis.kinds else self.problem

    def about(self, hypothesis: Hypothesis, at: Fit) -> Derivatives:
        """The derivatives about a fit of a set, as finely as the set needs; of the last fit asked they are known."""
        known = self._about
        if known is None or known.fit is not at or known.problem is not self.problem or known.released != self.released:
            linear = derivatives(self.posed(hypothesis), at, self.plant)
            self._about = known = _About(self.problem, at, self.released, linear)
        return known.derivatives

    def keep(self, hypothesis: Hypothesis, result: Fit) -> Fit:
        """Keep a fit if it is the best of its set; the best fit of the set."""
        before = self.found.get(hypothesis)
        if before is None or result.objective < before.objective:
            self.found[hypothesis] = result
        return self.found[hypothesis]

    def go_on(
        self, step: str, hypothesis: Hypothesis, iterations: int, in_a_row: int = 1, give_up_above: float = inf
    ) -> Fit:
        """Fit a set further from where it stands."""
        at = self.found[hypothesis]
        return self.try_set(step, hypothesis, at.values, at.states, iterations, at.free, in_a_row, give_up_above)

    def release(self, hypothesis: Hypothesis) -> None:
        """Fit a set on without the prior bounds that it rests on, if it does, and every other from then on.

        How far a nominal value is believed must not decide which physics is named: the nominal equations go on, too,
        for they may need no effect then.
        """
        at = self.found[hypothesis]
        names = at.held_by_belief() - self.released
        if not names:
            return
        self.released |= names
        for each in [known for known in self.found if known in (hypothesis, NOTHING)]:
            at = self.found[each]
            self.try_set("without prior bounds", each, at.values, at.states, TO_THE_END, self._in_plant(at), 2)

    def believe(self, hypothesis: Hypothesis) -> None:
        """Bring back the bounds that were released, if a set gains no more without them than by chance: those within
        which it is together, then one by one."""
        at = self.found[hypothesis]
        past = {base_name(name) for name, value in self._within(self.released, at).items() if value != at.values[name]}
        one_by_one = (frozenset({name}) for name in sorted(self.released))
        for names in dict.fromkeys([self.released - past, *one_by_one]):
            if not names <= self.released:
                continue
            at = self.found[hypothesis]
            self.released -= names
            values = {**at.values, **self._within(names, at)}
            result = fit(
                self.posed(hypothesis), values, self._in_plant(at), at.states, iterations=TO_THE_END, in_a_row=2
            )
            self.trace.add("within a prior bound", hypothesis, result)
            if result.objective - at.objective > chance_gain(at.count, at.data / at.count):
                self.released |= names
            else:
                self.found[hypothesis] = result

    def _within(self, names: Collection[str], at: Fit) -> dict[str, float]:
        """The values of nominal parameters of these names, moved within what is believed of them."""
        believed = {one.name: one for one in self.believed if one.name in names}
        return {
            name: min(max(value, one.lower), one.upper)
            for name, value in at.values.items() if (one := believed.get(base_name(name)))
        }  # fmt: skip

    def _in_plant(self, at: Fit) -> tuple[FreeParameter, ...]:
        """What a fit moves, the nominal parameters as they are now."""
        shooting = self.problem.shooting
        plant, _ = in_each(self.plant, at.values, shooting.per_recording, len(shooting.first_windows))
        names = {one.name for one in plant}
        return (*plant, *(one for one in at.free if one.name not in names))

    def measure_noise(self, hypothesis: Hypothesis) -> None:
        """Take each channel's noise from what a set leaves, if that is near it, and every fit so far with it.

        A model that is far off leaves a rough residual, and the noise seems larger than it is.
        """
        at, samplings = self.found[hypothesis], self.problem.shooting.samplings
        if at.data > FAR_FROM_NOISE * at.count:
            return
        before = self.problem.shooting
        noise = corrected_noise(before, at, self.filtered)
        if all(
            abs(level / sampling.noise - 1.0) < SAME_NOISE for level, sampling in zip(noise, samplings, strict=True)
        ):
            return
        self.problem = replace(self.problem, shooting=with_noise(before, noise))
        for other, result in self.found.items():
            self.found[other] = in_noise_of(self.problem, before, result)

    def leaves_noise(self, hypothesis: Hypothesis) -> bool:
        """Whether a set's residual is as small as the noise, and white."""
        result = self.found[hypothesis]
        return is_at_noise(result) and excess_of_block_means(self.problem, result, self.filtered) < WHITE

    def __iter__(self) -> Iterator[tuple[Hypothesis, Fit]]:
        return iter(self.found.items())


def excess_of_block_means(problem: Problem, result: Fit, filtered: Collection[str] = ()) -> float:
    """By how many standard deviations the sum of a residual's squared block means exceeds that of white noise of its
    size, over the windows in use, without the channels that are `filtered`: their noise is coloured."""
    used, excess, count = problem.used(), 0.0, 0
    shooting = problem.shooting
    for name, sampling, residual in zip(shooting.names, shooting.samplings, result.residuals, strict=True):
        left = residual[used[sampling.window]]
        means = block_means(left, BLOCK)
        if len(means) == 0 or name in filtered:
            continue
        excess += float(means @ means) * BLOCK / max(1.0, float(np.mean(left**2))) - len(means)
        count += len(means)
    return excess / np.sqrt(2.0 * count) if count else 0.0


def without_bounds(
    plant: Sequence[FreeParameter], names: Collection[str], problem: Problem
) -> tuple[FreeParameter, ...]:
    """The plant's parameters, those of these names as free as if nobody knew their values."""
    rows = problem.shooting.composition.place_rows
    return tuple(not_believed(one, rows[one.name]) if one.name in names else one for one in plant)


def in_noise_of(problem: Problem, before: Shooting, result: Fit) -> Fit:
    """A fit as it is in the noise of another problem: the same model, another chi^2."""
    used = problem.used()
    pairs = zip(problem.shooting.samplings, before.samplings, result.residuals, strict=True)
    residuals = tuple(residual * (then.noise / now.noise) for now, then, residual in pairs)
    kept = zip(problem.shooting.samplings, residuals, strict=True)
    data = sum(float(np.sum(residual[used[sampling.window]] ** 2)) for sampling, residual in kept)
    return replace(result, residuals=residuals, data=data, objective=result.objective - result.data + data)
