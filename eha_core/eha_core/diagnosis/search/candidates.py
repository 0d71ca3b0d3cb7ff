"""What a search has fitted so far: the best fit of each hypothesis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.hypothesis import Hypothesis, neutral
from eha_core.diagnosis.search.found import MOST_FITS, Effort, Found, Progress, keep_better
from eha_core.effects import Effect
from eha_core.health.noise import residual_noise
from eha_core.identification.fit import Fit, fit, fit_in_stages, with_noise
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.numbers import Array
from eha_core.identification.observation import RESOLVED
from eha_core.identification.parallel import each
from eha_core.identification.per_recording import base_name, is_one_of
from eha_core.identification.problem import Problem
from eha_core.identification.shooting import Shooting

SAME_NOISE = 0.02
"""Share by which a channel's noise may seem to change before everything is weighed anew."""


@dataclass(frozen=True)
class Proposal:
    """Where a fit of a hypothesis begins: every value of the plant, what is free, and the windows' starts (None: those
    measured). `predicted` is the gain in chi^2 that a score test gives it. `in_stages`: the valve's dynamics stay
    where they are until the rest has converged."""

    hypothesis: Hypothesis
    values: Mapping[str, float]
    free: tuple[FreeParameter, ...]
    states: Array | None
    predicted: float = 0.0
    in_stages: bool = False


@dataclass(frozen=True)
class Candidate:
    """A hypothesis and the best fit of it so far."""

    hypothesis: Hypothesis
    fit: Fit

    @property
    def times_noise(self) -> float:
        """Chi^2 a sample: 1 where only noise is left."""
        return self.fit.data / self.fit.count

    @property
    def further(self) -> Proposal:
        """The same hypothesis, to be fitted on from where it stands."""
        return Proposal(self.hypothesis, self.fit.values, self.fit.free, self.fit.states)


@dataclass
class Search:
    """What is searched, and all that was fitted on the way, by hypothesis.

    `shorter`, `shortest`: see `from_short_windows`. `short`: the problem's windows are the first of these. They tell
    little about when an effect acts, and nothing goes far in them, so that the valve's dynamics need not wait for the
    rest. `effort`: what is fitted over short windows counts, too.
    """

    problem: Problem
    applicable: Sequence[Effect]
    scales: Scales
    progress: Progress = lambda _: None
    found: Found = field(default_factory=dict)
    shorter: Sequence[Shooting] = ()
    shortest: Sequence[Shooting] = ()
    short: bool = False
    effort: Effort = field(default_factory=Effort)

    @property
    def is_over(self) -> bool:
        """Whether it has made as many fits as it may."""
        return self.effort.fits >= MOST_FITS

    def leaves(self, best: Candidate, more_than: float) -> bool:
        """Whether the best leaves more than so much chi^2 a sample, and the search may go on."""
        return best.times_noise > more_than and not self.is_over

    def keep(self, hypothesis: Hypothesis, result: Fit) -> Candidate:
        """Keep a fit if it is the best of its hypothesis; the hypothesis with its best fit."""
        keep_better(self.found, hypothesis, result)
        return Candidate(hypothesis, self.found[hypothesis])

    @property
    def best(self) -> Candidate:
        """The hypothesis that came nearest so far; as it is then, for a later fit of it makes another candidate."""
        return min(self, key=lambda candidate: candidate.fit.objective)

    def try_proposal(self, proposal: Proposal, iterations: int, give_up_above: float = float("inf")) -> Candidate:
        """Fit a hypothesis from a proposal, and keep what is better than before."""
        (candidate,) = self.try_proposals([proposal], iterations, give_up_above)
        return candidate

    def try_proposals(
        self, proposals: Sequence[Proposal], iterations: int, give_up_above: float = float("inf")
    ) -> list[Candidate]:
        """Fit hypotheses from proposals, side by side, and keep what is better than before."""

        def fitted(proposal: Proposal) -> Fit:
            run = fit_in_stages if proposal.in_stages and not self.short else fit
            return run(
                self.problem, proposal.values, proposal.free, proposal.states,
                iterations=iterations, give_up_above=give_up_above,
            )  # fmt: skip

        self.effort.fits += len(proposals)
        results = each(fitted, proposals, self._announce)
        return [self.keep(proposal.hypothesis, result) for proposal, result in zip(proposals, results, strict=True)]

    def _announce(self, proposal: Proposal) -> None:
        self.progress(f"trying {' + '.join(proposal.hypothesis.ids)}")

    def go_on(self, candidate: Candidate, iterations: int, give_up_above: float = float("inf")) -> Candidate:
        """Fit a hypothesis further from where it stands."""
        return self.try_proposal(candidate.further, iterations, give_up_above)

    def measure_noise(self, at: Candidate) -> None:
        """Take each channel's noise from what a candidate leaves over, and every fit so far with it.

        A model that is far off leaves a rough residual, and the noise seems larger than it is.
        """
        samplings = self.problem.shooting.samplings
        changes = [float(np.clip(residual_noise(residual), 0.5, 2.0)) for residual in at.fit.residuals]
        floors = [RESOLVED["Pa" if sampling.column > 1 else "m"] / sampling.noise for sampling in samplings]
        changes = [max(change, floor) for change, floor in zip(changes, floors, strict=True)]
        if max(abs(change - 1.0) for change in changes) < SAME_NOISE:
            return
        noise = [change * sampling.noise for change, sampling in zip(changes, samplings, strict=True)]
        before = self.problem.shooting
        self.problem = replace(self.problem, shooting=with_noise(before, noise))
        for hypothesis, result in self.found.items():
            self.found[hypothesis] = in_noise_of(self.problem, before, result)

    def again(self, candidate: Candidate) -> Candidate:
        """A hypothesis with what is now its best fit."""
        return Candidate(candidate.hypothesis, self.found[candidate.hypothesis])

    def report(self, best: Candidate) -> None:
        """Tell what is best so far."""
        self.progress(f"{' + '.join(best.hypothesis.ids)}: {best.times_noise:.3g} times the noise's energy")

    def __iter__(self) -> Iterator[Candidate]:
        return (Candidate(hypothesis, result) for hypothesis, result in self.found.items())


def in_noise_of(problem: Problem, before: Shooting, result: Fit) -> Fit:
    """A fit as it is in the noise of another problem: the same model, another chi^2."""
    used = problem.used()
    pairs = zip(problem.shooting.samplings, before.samplings, result.residuals, strict=True)
    residuals = tuple(residual * (then.noise / now.noise) for now, then, residual in pairs)
    kept = zip(problem.shooting.samplings, residuals, strict=True)
    data = sum(float(np.sum(residual[used[sampling.window]] ** 2)) for sampling, residual in kept)
    return replace(result, residuals=residuals, data=data, objective=result.objective - result.data + data)


def without_effect(result: Fit, effect: Effect) -> tuple[dict[str, float], tuple[FreeParameter, ...]]:
    """A fit's values with one effect off, and what is then free."""
    off = neutral(effect)
    values = {name: off.get(base_name(name), value) for name, value in result.values.items()}
    return values, tuple(parameter for parameter in result.free if not is_one_of(parameter.name, off))
