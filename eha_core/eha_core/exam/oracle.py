"""An oracle that knows the concealed form: what a recording can tell at all, whoever looks at it.

It starts the truth again in windows of the recording from the true states, without the effect; the difference is the
effect's mark. What the nominal parameters, the window's initial state or a rival effect can imitate is projected out
(linearised at the truth). What is left, over the noise, is the log-likelihood that naming the effect can gain at best.
Windows that show the mark most are taken, so the gain is a lower bound of the whole recording's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_core.exam.case import POSITION_NOISE, PRESSURE_NOISE, Case
from eha_core.exam.plants import RIG_MISTAKES, UNCERTAIN
from eha_core.exam.truth import resume_truth
from eha_core.exam.truth.record import Effect

Array = NDArray[np.float64]

VOLUMES = ("actuator_displacement",)
"""What nobody knows of a rig to a per cent either: the oil in hoses and ports, which acts as a longer stroke does. A
position sensor's scale is imitated by the volumes with the valve's gain, the mass and the damping."""

WINDOW, WINDOWS = 1.0, 3
"""Length [s] and number of the windows."""
STEP = 1e-3
"""Relative step of the derivatives."""
TRUST = 0.5
"""Relative standard deviation within which any nominal value is believed."""
FREE = 1e3
"""Scale of the rival's column, with which its size is as good as free."""
DECIDABLE = 25.0
"""Nats. A case from which the oracle gains less is undecidable: several hypotheses with free sizes compete, and each
parameter they spend costs half the logarithm of the number of samples, about 5 nats."""
NO_LIMIT = 1e30
"""A parameter as large as this says that the law has no such limit."""
SHIFTS = {"position": 1e-5, "velocity": 1e-3, "pressure_a": 1e4, "pressure_b": 1e4}


@dataclass(frozen=True)
class Insight:
    """What the oracle sees.

    `gain`: log-likelihood [nats] that the concealed form gains over the nominal equations at their best.
    `residual`: RMS of what they cannot imitate, over the noise. `imitation`: relative changes of the nominal parameters
    that imitate the effect best. `beyond_rival`: the gain over the nominal equations with the rival effect.
    """

    gain: float
    residual: float
    imitation: Mapping[str, float]
    beyond_rival: float | None = None

    @property
    def decidable(self) -> bool:
        """Whether there is enough in the recording to name the effect."""
        return self.gain >= DECIDABLE


def consult(
    case: Case, truth: Mapping[str, Array], rival: Effect | None = None, kept: Sequence[Effect] = ()
) -> Insight:
    """Ask what the recording of a case can tell, and how much of that a rival effect does not explain at any size.

    Effects that are `kept` stay in the model, with any parameters: what is asked is what the others show beside them.
    """
    starts = _telling_windows(case, truth, kept)
    names = (*UNCERTAIN, *RIG_MISTAKES, *VOLUMES)
    blocks = [_window(case, truth, first, names, rival, kept) for first in starts]
    marks = np.concatenate([mark for mark, _ in blocks])
    columns = np.concatenate([matrix for _, matrix in blocks])
    gain, residual, solution = _best_imitation(marks, columns[:, : len(names)])
    beyond = None
    if rival is not None:
        columns[:, -1] *= FREE
        beyond = _best_imitation(marks, columns)[0]
    if kept:
        gain = _best_imitation(marks, columns)[0]
    return Insight(gain, residual, dict(zip(names, solution.tolist(), strict=True)), beyond)


def seen_beside_the_others(case: Case, truth: Mapping[str, Array]) -> tuple[str, ...]:
    """The concealed effects that the recording can show, each beside all the others with any parameters."""
    seen = []
    for effect in case.effects:
        others = [other for other in case.effects if other is not effect]
        if consult(case, truth, kept=others).decidable:
            seen.append(effect[0])
    return tuple(seen)


def _best_imitation(marks: Array, columns: Array) -> tuple[float, float, Array]:
    """Log-likelihood and RMS that the columns leave of the marks, and how much of each column is taken."""
    count = columns.shape[1]
    matrix = np.concatenate([columns, np.eye(count) / TRUST])
    solution, *_ = np.linalg.lstsq(matrix, np.concatenate([marks, np.zeros(count)]), rcond=None)
    left = marks - columns @ solution
    gain = 0.5 * float(left @ left + np.sum((solution / TRUST) ** 2))
    return gain, float(np.sqrt(np.mean(left**2))), solution


def _length(case: Case) -> int:
    return round(WINDOW * case.rate)


def _telling_windows(case: Case, truth: Mapping[str, Array], kept: Sequence[Effect]) -> list[int]:
    """First samples of the windows in which leaving the effect out matters most."""
    length = _length(case)
    candidates = list(range(0, len(truth["time"]) - length, length))
    energies = [float(np.sum(_mark(case, truth, first, kept) ** 2)) for first in candidates]
    order = np.argsort(energies)[::-1][:WINDOWS]
    return sorted(candidates[i] for i in order)


def _scaled(case: Case, columns: Mapping[str, Array]) -> Array:
    """The recorded channels over their noise, one after the other."""
    pieces = [columns["measured_position"] / (case.noise * POSITION_NOISE)]
    for channel in ("pressure_a", "pressure_b"):
        if channel in case.channels:
            pieces.append(columns[f"measured_{channel}"] / (case.noise * PRESSURE_NOISE))
    return np.concatenate(pieces)


def _mark(case: Case, truth: Mapping[str, Array], first: int, kept: Sequence[Effect]) -> Array:
    last = first + _length(case)
    there = {name: column[first : last + 1] for name, column in truth.items()}
    return _scaled(case, there) - _scaled(case, resume_truth(case.plant, kept, truth, first, last))


def _doubted(values: Mapping[str, object]) -> list[str]:
    """The parameters of an effect that a diagnosis has to fit: its sizes, and the shape of its law."""
    return [name for name, value in values.items() if isinstance(value, float) and 0.0 < abs(value) < NO_LIMIT]


def _window(
    case: Case,
    truth: Mapping[str, Array],
    first: int,
    names: Sequence[str],
    rival: Effect | None,
    kept: Sequence[Effect],
) -> tuple[Array, Array]:
    """The effect's mark in one window and the columns that can imitate it, free of the window's initial state.

    Columns: one for each nominal parameter and each parameter of a kept effect (relative changes), one for the rival.
    """
    last = first + _length(case)
    there = _scaled(case, {name: column[first : last + 1] for name, column in truth.items()})
    nominal = _scaled(case, resume_truth(case.plant, kept, truth, first, last))
    columns = []
    for name in names:
        nudged = {**case.plant, name: case.plant[name] * (1.0 + STEP)}
        columns.append((_scaled(case, resume_truth(nudged, kept, truth, first, last)) - nominal) / STEP)
    for place, (name, values) in enumerate(kept):
        for parameter in _doubted(values):
            larger = (name, {**values, parameter: float(values[parameter]) * (1.0 + STEP)})
            changed = (*kept[:place], larger, *kept[place + 1 :])
            columns.append((_scaled(case, resume_truth(case.plant, changed, truth, first, last)) - nominal) / STEP)
    if rival is not None:
        columns.append(_scaled(case, resume_truth(case.plant, (*kept, rival), truth, first, last)) - nominal)
    states = [
        _scaled(case, resume_truth(case.plant, kept, truth, first, last, shift={name: step})) - nominal
        for name, step in SHIFTS.items()
    ]
    basis = np.linalg.qr(np.stack(states, axis=1))[0]
    stacked = np.column_stack([there - nominal, *columns])
    free = stacked - basis @ (basis.T @ stacked)
    return free[:, 0], free[:, 1:]
