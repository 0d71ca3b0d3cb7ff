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

LEVELS = 5
GENTLEST = 0.25
"""How many amplitudes are tried, from this share of the voltage used so far up to the valve's saturation."""

TELLING = 50.0
"""A test is worth proposing when it separates the rivals by this much chi^2."""


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
    """The trial that separates the first two rivals most, inside the rig's stroke, its pressures and its voltage.

    `noises` are the channels' [their unit], `level` is the voltage used so far and `voltage_limit` the largest [V].
    """
    (first_ids, first), (second_ids, second) = rivals[0], rivals[1]
    best, best_separation = Trial("sine", {"amplitude": 0.0, "frequency": 1.0}), -1.0
    while best_separation < 0.0 and voltage_limit > FAINTEST:
        for trial in trials(level, voltage_limit):
            separation = _separation(trial, first, second, noises)
            if separation is not None and separation > best_separation:
                best, best_separation = trial, separation
        voltage_limit = min(GENTLEST * level, voltage_limit)  # where the rig bears none of them, fainter ones
        level = GENTLEST * voltage_limit
    separates = tuple(dict.fromkeys([*first_ids, *second_ids]))
    how = ", ".join(f"{name} {value:.3g}" if isinstance(value, float) else f"{name} {value}"
                    for name, value in best.parameters.items())  # fmt: skip
    told = "should tell them apart" if best_separation > TELLING else "tells them apart best, though hardly"
    statement = (
        f"{' and '.join(first_ids)} or {' and '.join(second_ids)}: a {best.signal} of voltage ({how})"
        f" for {DURATION:g} s {told} (expected: {np.sqrt(max(best_separation, 0.0)):.0f} deviations of noise)"
    )
    return Experiment(statement, separates, best.reference())


def _separation(trial: Trial, first: Fit, second: Fit, noises: Mapping[str, float]) -> float | None:
    """Chi^2 between the two models' responses that the first one's parameters cannot imitate; None past a limit."""
    times = np.arange(round(DURATION / STEP)) * STEP
    try:
        voltage = np.asarray(make_signal(trial.signal, dict(trial.parameters)).value(times))
    except Exception as error:
        raise RuntimeError(f"trial {trial}") from error
    one = _respond(first.values, voltage)
    if one is None or not _bearable(one, first.values):
        return None
    two = _respond(second.values, voltage)
    if two is None:
        return None
    base, other = _scaled(one, noises), _scaled(two, noises)
    columns = []
    for free in first.free:
        moved = _respond(_nudged(first.values, free), voltage)
        if moved is not None:
            columns.append(_scaled(moved, noises) - base)
    difference = other - base
    if columns:
        matrix = np.stack(columns, axis=1)
        norms = np.linalg.norm(matrix, axis=0)
        matrix = matrix[:, norms > 1e-9] / norms[norms > 1e-9]
        imitated, *_ = np.linalg.lstsq(matrix, difference, rcond=1e-8)
        difference = difference - matrix @ imitated
    return float(difference @ difference)


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
