"""Stage 5, each effect's contribution: the residuals of the nominal, recalibrated and augmented models, and of the last
without each effect.

The curvature at the optimum does not give it: without a valve's overlap or a leak the other parameters move so far that
a quadratic prediction of the residual's RMS is wrong by a factor of 5 to 15 (two sets of the example recordings). So
the rest is refitted, once for each effect.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from eha_core.diagnosis.calibrate import corrected_noise, filtered_channels
from eha_core.diagnosis.criteria import TO_THE_END
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.hypothesis import Member, without_effect
from eha_core.diagnosis.result import AUGMENTED, NOMINAL, RECALIBRATED, Correlation, Residual, Step
from eha_core.diagnosis.search.comparison import Entry
from eha_core.identification.fit import Fit, fit
from eha_core.identification.parallel import each


def ladder(evidence: Evidence, final: Fit) -> tuple[tuple[Step, ...], dict[str, Residual]]:
    """The residuals of the models from nominal to final, and those without each of several effects, largest first."""
    winner = evidence.decision.winner
    scales = _scales(evidence)
    steps = [
        Step(NOMINAL, _residual(evidence, evidence.calibration.nominal, scales)),
        Step(RECALIBRATED, _residual(evidence, evidence.comparison.nominal.fit, scales)),
    ]
    members = winner.hypothesis.members
    if members:
        # the final fit's residuals are already scaled by its own noise levels
        steps.append(Step(AUGMENTED, _residual(evidence, final, [1.0] * len(scales))))
    if len(members) < 2:
        return tuple(steps), {}
    refits = each(partial(_without, evidence, winner), members)
    left = {member.id: _residual(evidence, refit, scales) for member, refit in zip(members, refits, strict=True)}
    return tuple(steps), dict(sorted(left.items(), key=lambda item: -item[1].overall))


def _without(evidence: Evidence, winner: Entry, member: Member) -> Fit:
    """The set without one member, fitted further: the search's fit may have given up when it was far enough off."""
    known = evidence.comparison.smaller.get(winner.hypothesis.without(member))
    if known is not None:
        values, free, states = known.values, known.free, known.states
    else:
        values, free = without_effect(winner.fit, member.effect)
        states = winner.fit.states
    return fit(evidence.calibration.problem, values, free, states, iterations=TO_THE_END)


def _scales(evidence: Evidence) -> list[float]:
    """Each channel's noise level in the search, divided by that under the final model."""
    shooting = evidence.calibration.shooting
    final = corrected_noise(shooting, evidence.decision.winner.fit, filtered_channels(evidence.observations))
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
    # each parameter increases with its coordinate, so both have the same correlation
    matrix = np.clip(covariance / np.outer(deviations, deviations), -1.0, 1.0)
    np.fill_diagonal(matrix, 1.0)
    return Correlation(tuple(parameter.name for parameter in final.free), tuple(map(tuple, matrix.tolist())))
