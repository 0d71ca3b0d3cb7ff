"""Stage 7, next experiment: the voltage test whose outcome would tell rival explanations apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.fit import Fit
from eha_core.diagnosis.freedom import Free
from eha_core.diagnosis.numbers import Array
from eha_core.diagnosis.result import Experiment
from eha_core.plant import COLUMNS, Plant
from eha_core.signals import make_signal

DURATION = 10.0
STEP = 2e-4
ROWS_EVERY = 5
STROKE_SHARE = 0.85
"""Of the stroke, that a proposed test may use."""

PRESSURE_SHARE = 1.2
"""Of the supply pressure, that a chamber may reach in it; and none may fall to a vacuum."""

FAINTEST = 1e-4
"""V; below this there is no test."""

MOST_RIVALS = 3
"""How many rivals of the winner a test is made for."""

LEVELS = 5
GENTLEST = 0.25
"""How many amplitudes are tried, from this share of the voltage used so far up to the valve's saturation."""

TELLING = 50.0
"""A test is worth proposing when it separates the rivals by this much chi^2."""

PRESSURES = {"pressure_a": 1e4, "pressure_b": 1e4}
"""Channels that tell more where a voltage alone does not, and the noise [Pa] that is assumed of their sensors."""


@dataclass(frozen=True)
class Trial:
    """A signal for the reference generator, by name and parameters."""

    signal: str
    parameters: Mapping[str, float | str | bool]

    def reference(self) -> dict[str, object]:
        """As the reference node's parameters."""
        return {
            "mode": "voltage",
            "signal": self.signal,
            **{f"{self.signal}.{k}": v for k, v in self.parameters.items()},
        }


def trials(level: float, limit: float) -> Iterator[Trial]:
    """Tests from a gentle share of the voltage used so far up to the limit [V], slow to fast."""
    for amplitude in np.geomspace(min(GENTLEST * level, limit), limit, LEVELS).tolist():
        for frequency in (0.3, 1.0, 3.0, 8.0):
            yield Trial("sine", {"amplitude": amplitude, "frequency": frequency})
        yield Trial(
            "chirp", {"amplitude": amplitude, "start_frequency": 0.2, "end_frequency": 12.0, "duration": DURATION}
        )
        for period in (0.4, 1.5, 4.0):
            yield Trial("square", {"amplitude": amplitude, "frequency": 1.0 / period})
        yield Trial("prbs", {"amplitude": amplitude})
        yield Trial("multisine", {"amplitude": amplitude})


def propose(
    rivals: Sequence[tuple[tuple[str, ...], Fit]], noises: Mapping[str, float], level: float, voltage_limit: float
) -> Experiment:
    """The trial that separates the first rival most from all others, inside the rig's stroke, pressures and voltage.

    Where no voltage separates them in the channels there are, the pressures are asked for too. `noises` are the
    channels' [their unit], `level` is the voltage used so far and `voltage_limit` the largest [V].
    """
    first, others = rivals[0][1], [rival for _, rival in rivals[1 : MOST_RIVALS + 1]]
    record: tuple[str, ...] = ()
    best, separation = _best_trial(first, others, noises, level, voltage_limit)
    if separation < TELLING and not set(PRESSURES) <= set(noises):
        record = tuple(name for name in PRESSURES if name not in noises)
        best, separation = _best_trial(first, others, {**PRESSURES, **noises}, level, voltage_limit)
    how = ", ".join(f"{name} {value:.3g}" if isinstance(value, float) else f"{name} {value}"
                    for name, value in best.parameters.items())  # fmt: skip
    names = [ids for ids, _ in rivals[: MOST_RIVALS + 1]]
    beside = ", with the chambers' pressures recorded too," if record else ""
    told = "should tell them apart" if separation > TELLING else "tells them apart best, though hardly"
    statement = (
        f"{' or '.join(' and '.join(ids) for ids in names)}: a {best.signal} of voltage ({how})"
        f" for {DURATION:g} s{beside} {told} (expected: {np.sqrt(max(separation, 0.0)):.0f} deviations of noise)"
    )
    separates = tuple(dict.fromkeys(name for ids in names for name in ids))
    return Experiment(statement, separates, best.reference(), record)


def _best_trial(
    first: Fit, others: Sequence[Fit], noises: Mapping[str, float], level: float, voltage_limit: float
) -> tuple[Trial, float]:
    """The trial that separates a model most from the nearest of the others, and by how much chi^2."""
    best, best_separation = Trial("sine", {"amplitude": 0.0, "frequency": 1.0}), -1.0
    while best_separation < 0.0 and voltage_limit > FAINTEST:
        for trial in trials(level, voltage_limit):
            separation = _separation(trial, first, others, noises)
            if separation is not None and separation > best_separation:
                best, best_separation = trial, separation
        voltage_limit = min(GENTLEST * level, voltage_limit)  # where the rig bears none of them, fainter ones
        level = GENTLEST * voltage_limit
    return best, best_separation


def _separation(trial: Trial, first: Fit, others: Sequence[Fit], noises: Mapping[str, float]) -> float | None:
    """Least chi^2 between the first model's response and another's that the first one's parameters cannot imitate; None
    past a limit."""
    times = np.arange(round(DURATION / STEP)) * STEP
    voltage = np.asarray(make_signal(trial.signal, dict(trial.parameters)).value(times))
    rows = _respond(first.values, voltage)
    if rows is None or not _bearable(rows, first.values):
        return None
    responses = [_respond(other.values, voltage) for other in others]
    base = _scaled(rows, noises)
    differences = np.stack([_scaled(one, noises) - base for one in responses if one is not None], axis=1)
    if differences.shape[1] < len(others):
        return None
    columns = []
    for free in first.free:
        moved = _respond(_nudged(first.values, free), voltage)
        if moved is not None:
            columns.append(_scaled(moved, noises) - base)
    if columns:
        matrix = np.stack(columns, axis=1)
        norms = np.linalg.norm(matrix, axis=0)
        matrix = matrix[:, norms > 1e-9] / norms[norms > 1e-9]
        imitated, *_ = np.linalg.lstsq(matrix, differences, rcond=1e-8)
        differences = differences - matrix @ imitated
    return float(np.min(np.sum(differences**2, axis=0)))


def _bearable(rows: Array, values: Mapping[str, float]) -> bool:
    """Whether a response stays inside the stroke, and its pressures between a vacuum and what the rig bears."""
    position = rows[:, COLUMNS.index("position")]
    pressures = rows[:, [COLUMNS.index("pressure_a"), COLUMNS.index("pressure_b")]]
    inside = bool(np.max(np.abs(position)) < STROKE_SHARE * values["actuator_displacement"])
    most = PRESSURE_SHARE * values["supply_pressure"]
    return inside and bool(np.min(pressures) > -values["atmospheric_pressure"] and np.max(pressures) < most)


def _nudged(values: Mapping[str, float], free: Free) -> dict[str, float]:
    at = free.coordinate(values[free.name])
    return {**values, free.name: free.value(at + 1e-3)}


def _respond(values: Mapping[str, float], voltage: Array) -> Array | None:
    rows = Plant(values, STEP).run(voltage, ROWS_EVERY).values
    return rows if np.all(np.isfinite(rows)) else None


def _scaled(rows: Array, noises: Mapping[str, float]) -> Array:
    """The measured channels over their noise, one after the other; drift of the position is taken out by its mean."""
    pieces = [rows[:, COLUMNS.index(f"measured_{name}")] / noise for name, noise in noises.items()]
    return np.concatenate([piece - piece.mean() for piece in pieces])
