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


def trials(level: float) -> Iterator[Trial]:
    """Tests about a voltage that the recording has shown to be usable [V], gentle to strong, slow to fast."""
    for factor in (0.25, 1.0, 2.5):
        amplitude = factor * level
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
    """The trial that separates the first two rivals most, inside the rig's stroke and pressure and the voltage used."""
    (first_ids, first), (second_ids, second) = rivals[0], rivals[1]
    best, best_separation = None, -1.0
    for trial in trials(level):
        if abs(float(trial.parameters["amplitude"])) > voltage_limit:
            continue
        separation = _separation(trial, first, second, noises)
        if separation is not None and separation > best_separation:
            best, best_separation = trial, separation
    separates = tuple(dict.fromkeys([*first_ids, *second_ids]))
    if best is None:
        best = Trial(
            "chirp", {"amplitude": 0.1 * level, "start_frequency": 0.2, "end_frequency": 12.0, "duration": DURATION}
        )
        best_separation = 0.0
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
    stroke = first.values["actuator_displacement"]
    if one is None or np.max(np.abs(one[:, COLUMNS.index("position")])) > STROKE_SHARE * stroke:
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
