"""Stage 3, locate: where in state space, and when, a model's residual is largest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.characteristic_scales import Scales, scales_alone
from eha_core.diagnosis.criteria import LOUD_SLICE, SLICE
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.shooting import Shooting
from eha_core.identification.together import fit_alone, recording_alone


@dataclass(frozen=True)
class Region:
    """A part of state space, and the shares of the record's time and of the unexplained energy that fall into it."""

    name: str
    time_share: float
    energy_share: float


def whereabouts(
    shooting: Shooting, result: Fit, scales: Scales, recording: int = 1
) -> tuple[str, tuple[tuple[float, float], ...]]:
    """The part of state space and the intervals [s] with the largest residuals of a recording, counted from one."""
    alone, of_it = recording_alone(shooting, recording), fit_alone(shooting, result, recording)
    return _where(alone, of_it, scales_alone(shooting, scales, recording)), _when(alone, of_it)


def _energy(shooting: Shooting, result: Fit) -> tuple[Array, Array]:
    """The times [s] and squared residuals of all channels' samples."""
    times = [shooting.times(sampling) for sampling in shooting.samplings]
    return np.concatenate(times), np.concatenate([residual**2 for residual in result.residuals])


def _when(shooting: Shooting, result: Fit) -> tuple[tuple[float, float], ...]:
    """The intervals [s] of large residuals; the whole record if they take most of it."""
    times, energy = _energy(shooting, result)
    end = float(shooting.edges[-1]) * shooting.step_size
    edges = np.arange(0.0, end + SLICE, SLICE)
    place = np.clip(np.digitize(times, edges) - 1, 0, len(edges) - 2)
    counts = np.bincount(place, minlength=len(edges) - 1)
    means = np.bincount(place, weights=energy, minlength=len(edges) - 1) / np.maximum(counts, 1)
    loud = means > max(LOUD_SLICE, 0.1 * float(means.max()))
    if not loud.any():
        return ()
    if loud.mean() > 0.6:
        return ((0.0, end),)
    starts = np.flatnonzero(loud & ~np.concatenate([[False], loud[:-1]]))
    stops = np.flatnonzero(loud & ~np.concatenate([loud[1:], [False]]))
    spans = [(float(edges[first]), float(min(edges[last + 1], end))) for first, last in zip(starts, stops, strict=True)]
    return tuple(spans)


def regions(shooting: Shooting, result: Fit, scales: Scales) -> tuple[Region, ...]:
    """The shares of time, and of the worst channel's unexplained energy, in each part of state space that an engineer
    would name."""
    if not len(scales.rows):
        return ()
    sampling, residual = max(
        zip(shooting.samplings, result.residuals, strict=True), key=lambda pair: float(np.mean(pair[1] ** 2))
    )
    at = sampling.row
    energy = np.maximum(residual**2 - 1.0, 0.0)
    total = float(energy.sum()) or 1.0
    speed, spool, position = (scales.column(name)[at] for name in ("velocity", "spool_position", "position"))
    pressure = np.maximum(scales.column("pressure_a")[at], scales.column("pressure_b")[at])
    masks = {
        "near zero speed": np.abs(speed) < 0.15 * np.std(speed),
        "near the valve's null": np.abs(spool) < 0.15 * np.std(spool),
        "at high speed": np.abs(speed) > 1.5 * np.std(speed),
        "at large valve opening": np.abs(spool) > 1.5 * np.std(spool),
        "at high pressure": pressure > np.quantile(pressure, 0.9),
        "at the upper end of the travel": position > np.quantile(position, 0.92),
        "at the lower end of the travel": position < np.quantile(position, 0.08),
    }
    return tuple(Region(name, float(mask.mean()), float(energy[mask].sum()) / total) for name, mask in masks.items())


def _where(shooting: Shooting, result: Fit, scales: Scales) -> str:
    """The region with the most energy for its share of time, if one stands out."""
    candidates = [region for region in regions(shooting, result, scales) if region.time_share > 0.005]
    best = max(candidates, key=lambda region: region.energy_share / region.time_share, default=None)
    if best is None or best.energy_share < 2.0 * best.time_share or best.energy_share < 0.15:
        return "all over the states that were visited"
    return best.name
