"""Stage 5, what each effect is worth: the models between the nominal one and the whole set.

The set is taken apart by backward elimination: the member without which the rest, fitted again, explains most goes
first. Read backwards, that is the order in which the members earn their place.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from eha_core.diagnosis.calibrate import corrected_noise
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.hypothesis import Hypothesis, Member
from eha_core.diagnosis.result import NOMINAL, RECALIBRATED, Correlation, Residual, Step
from eha_core.diagnosis.hypothesis import without_effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.parallel import each


REFITTED = 8
"""Iterations of a fit without a member."""


class Fitted(NamedTuple):
    """A set and a fit of it."""

    hypothesis: Hypothesis
    fit: Fit


def ladder(evidence: Evidence, final: Fit) -> tuple[tuple[Step, ...], dict[str, Residual]]:
    """The steps from the nominal model to the final one, and what the set leaves without each of several members."""
    winner = evidence.decision.winner
    whole = Fitted(winner.hypothesis, winner.fit)
    models, without = _taken_apart(evidence, whole)
    ends = (
        (NOMINAL, evidence.calibration.nominal),
        (RECALIBRATED, evidence.comparison.nominal.fit),
        *((member.id, candidate.fit) for member, candidate in models),
    )
    scales = _scales(evidence)
    steps = [Step(added, _residual(evidence, result, scales)) for added, result in ends]
    if models:
        steps[-1] = Step(steps[-1].added, _residual(evidence, final, [1.0] * len(scales)))
    return tuple(steps), {
        member.id: _residual(evidence, candidate.fit, scales) for member, candidate in without.items()
    }


def _taken_apart(
    evidence: Evidence, whole: Fitted
) -> tuple[list[tuple[Member, Fitted]], dict[Member, Fitted]]:
    """Each member with the model that it completes, the first to be added first; and the set without each.

    Every member is taken out of every set on the way: where the parameters can make up for much of a member, the
    curvature at the fit does not tell what it is worth.
    """
    known = {entry.hypothesis: entry.fit for entry in evidence.comparison.entries}
    found: list[tuple[Member, Fitted]] = []
    without: dict[Member, Fitted] = {}
    rest = whole
    while len(rest.hypothesis.members) > 1:
        members = rest.hypothesis.members
        refitted = each(partial(_refit_without, evidence, rest, known), members)
        smaller = dict(zip(members, refitted, strict=True))
        without = without or smaller
        goes = min(smaller, key=lambda member: smaller[member].fit.objective)
        found.append((goes, rest))
        rest = smaller[goes]
    found += [(member, rest) for member in rest.hypothesis.members]
    return found[::-1], without


def _refit_without(evidence: Evidence, at: Fitted, known: Mapping[Hypothesis, Fit], member: Member) -> Fitted:
    """The set without one member, fitted from where the whole set stands, or as the search has fitted it if that is
    better."""
    values, free = without_effect(at.fit, member.effect)
    result = fit(evidence.calibration.problem, values, free, at.fit.states, iterations=REFITTED)
    hypothesis = at.hypothesis.without(member)
    earlier = known.get(hypothesis, result)
    return Fitted(hypothesis, min(result, earlier, key=lambda model: model.objective))


def _scales(evidence: Evidence) -> list[float]:
    """What the search took for each channel's noise, over what the final model shows it to be."""
    shooting = evidence.calibration.shooting
    final = corrected_noise(shooting, evidence.decision.winner.fit)
    return [sampling.noise / noise for sampling, noise in zip(shooting.samplings, final, strict=True)]


def _residual(evidence: Evidence, result: Fit, scales: Sequence[float]) -> Residual:
    left = [scale * residual for scale, residual in zip(scales, result.residuals, strict=True)]
    names = evidence.calibration.shooting.names
    channels = {name: float(np.sqrt(np.mean(residual**2))) for name, residual in zip(names, left, strict=True)}
    return Residual(channels, float(np.sqrt(np.mean(np.concatenate(left) ** 2))))


def correlation(final: Fit) -> Correlation:
    """Correlation of the fitted parameters' errors, from the covariance at the optimum."""
    count = len(final.free)
    covariance = final.covariance[:count, :count]
    deviations = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    # a parameter rises with its coordinate, so both have the same correlation
    matrix = np.clip(covariance / np.outer(deviations, deviations), -1.0, 1.0)
    np.fill_diagonal(matrix, 1.0)
    return Correlation(tuple(parameter.name for parameter in final.free), tuple(map(tuple, matrix.tolist())))
