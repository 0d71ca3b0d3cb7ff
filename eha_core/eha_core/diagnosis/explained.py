"""Stage 5, the residual: how much the fitted model explains, where it fails, and how well it predicts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.calibrate import filtered_channels
from eha_core.diagnosis.criteria import COHERENT, IDENTIFIED, LEFT_IN_A_CHANNEL
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.locate import whereabouts
from eha_core.diagnosis.result import ChannelFit, Explained, Location, Prediction
from eha_core.diagnosis.verdict import coherence
from eha_core.effects import Effect
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.observation import Observation
from eha_core.identification.segments import cut

AHEAD = (0.25, 1.0)
"""s; prediction horizons from measured states."""


def explained(evidence: Evidence, final: Fit, held_out: Mapping[str, ChannelFit]) -> Explained:
    """The share of the recalibrated model's excess chi^2 that the fit explains, and the residual: in each channel the
    larger of the training and the held-out one."""
    names = evidence.calibration.shooting.names
    fitted = {name: root_mean_square(residual) for name, residual in zip(names, final.residuals, strict=True)}
    # a wrong local minimum can reach the noise on training data, but not on held-out data
    left = {name: max(size, held_out[name].rmse_after / held_out[name].noise) for name, size in fitted.items()}
    filtered = filtered_channels(evidence.observations)  # whose noise is not white by itself
    pairs = zip(names, final.residuals, strict=True)
    white = all(coherence(residual) < COHERENT for name, residual in pairs if name not in filtered)
    identified = all(is_identified(effect, final) for effect in evidence.decision.winner.effects if effect.named)
    noise = max(left.values()) < LEFT_IN_A_CHANNEL and white
    before = evidence.comparison.nominal.fit
    missing = max(before.data - before.count, 0.0)
    # the winner as the search fitted it: the final fit's chi^2 is over other noise levels
    beyond = max(evidence.decision.winner.fit.data - before.count, 0.0)
    share = 1.0 - beyond / missing if missing > 0.0 else 1.0
    rest = () if noise else _left_over(evidence)
    return Explained(max(share, 0.0), left, noise and identified, rest, noise and not identified)


def root_mean_square(values: Array) -> float:
    """The root of the mean of squares."""
    return float(np.sqrt(np.mean(values**2)))


def is_identified(effect: Effect, final: Fit) -> bool:
    """Whether a fitted value of an effect differs from its neutral value by more than its confidence interval.

    A force of 18 kN +- 593 kN is no explanation, however small the residual.
    """
    free = {parameter.name for parameter in final.free}
    rows = {f"{effect.id}.{row.name}": row for row in effect.parameters}
    fitted = {name: row for name, row in rows.items() if name in free}
    return not fitted or any(
        abs(final.values[name] - row.nominal) > IDENTIFIED * final.deviation(name) for name, row in fitted.items()
    )


def _left_over(evidence: Evidence) -> tuple[Location, ...]:
    """Where and when the residual is largest, at the sites where a score test predicts the largest gain of another
    effect."""
    winner = evidence.decision.winner
    where, when = whereabouts(evidence.calibration.shooting, winner.fit, evidence.scales, evidence.lead)
    sites = evidence.comparison.left_over
    total = sum(sites.values())
    ranked = sorted(sites.items(), key=lambda item: -item[1])[:3]
    return tuple(Location(site, gain / total, where, when) for site, gain in ranked if gain > 0.05 * total)


def predictions(observation: Observation, values: Mapping[str, float], step_size: float) -> Mapping[str, Prediction]:
    """RMSE of a model's prediction of each channel: over the horizons AHEAD, and free-running over the whole record."""
    ahead = {
        seconds: _errors(observation, values, step_size, seconds) for seconds in AHEAD if seconds < observation.duration
    }
    running = _errors(observation, values, step_size, 2.0 * observation.duration)
    return {
        name: Prediction({seconds: errors[name] for seconds, errors in ahead.items()}, error)
        for name, error in running.items()
    }


def _errors(
    observation: Observation, values: Mapping[str, float], step_size: float, seconds: float
) -> Mapping[str, float]:
    """RMSE of every channel, restarted from the measured states every `seconds`."""
    shooting = cut(observation, values, step_size, seconds)
    rows, _ = shooting.simulate(values, shooting.initial_states)
    triples = zip(shooting.names, shooting.samplings, shooting.sample(rows), strict=True)
    return {name: float(np.sqrt(np.mean((sampling.values - model) ** 2))) for name, sampling, model in triples}
