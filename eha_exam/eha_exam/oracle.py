"""An oracle that knows the concealed form: what a recording can tell at all, whoever looks at it.

It starts the truth again in windows of the recording from the true states, without the effect; the difference is the
effect's mark. What the nominal parameters, the window's initial state or a rival effect can imitate is projected out
(linearised at the truth). What is left, over the noise, is the log-likelihood that naming the effect can gain at best.
Windows that show the mark most are taken; the whole recording holds more. Where an imitation is too large for one
linearisation, the gain is too high.

A large effect may be imitated by changes too large for one linearisation: a position that reads 9 % short, exactly, by
gain, leakage, volumes, mass and damping. Where one nearly imitates it all, the imitation is simulated and improved. So
it is for air in the oil, which oil that is as soft imitates: where it rings, no linearisation finds that.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_exam.case import Case
from eha_exam.imitation import SHIFTS, TRUST, Doubted, as_soft, left_by_the_best, length, scaled
from eha_exam.plants import RIG_MISTAKES, UNCERTAIN
from eha_exam.truth import resume_truth
from eha_exam.truth.record import Effect

Array = NDArray[np.float64]

VOLUMES = ("actuator_displacement",)
"""What nobody knows of a rig to a per cent either: the oil in hoses and ports, which acts as a longer stroke does. A
position sensor's scale is imitated by the volumes with the valve's gain, the mass and the damping."""

NAMES = (*UNCERTAIN, *RIG_MISTAKES, *VOLUMES)
"""The nominal parameters that may imitate an effect."""

WINDOWS = 3
"""How many windows are looked at."""
FREE = 1e3
"""Scale of the rival's column, with which its size is as good as free."""
DECIDABLE = 25.0
"""Nats. A case from which the oracle gains less is undecidable: several hypotheses with free sizes compete, and each
parameter they spend costs half the logarithm of the number of samples, about 5."""

NEARLY = 2e-4
"""Share of the mark's energy below which what a linearised imitation leaves an exact one may not: where that takes
changes of a tenth, a hundredth of the mark's size is left, a ten-thousandth of its energy. Of a position sensor's scale
7e-5 at most was left, of effects that show 6e-4 at least (development cases of seed 70219)."""


@dataclass(frozen=True)
class Insight:
    """What the oracle sees.

    `gain`: log-likelihood that the concealed form gains over the nominal equations at their best.
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
    model = Doubted(case, truth, NAMES, tuple(kept))
    windows = [model.linearised(first, np.zeros(model.size), np.zeros(len(SHIFTS))) for first in starts]
    marks = np.concatenate([at.of_any_start(at.left) for at in windows])
    columns = np.concatenate([at.of_any_start(at.by_change) for at in windows])
    gain, residual, solution = _best_imitation(marks, columns[:, : len(NAMES)])
    beyond = None
    if rival is not None:
        rivals = [at.of_any_start(model.with_rival(first, rival)) for first, at in zip(starts, windows, strict=True)]
        beyond = _best_imitation(marks, np.column_stack([columns, FREE * np.concatenate(rivals)]))[0]
    if kept:
        gain = _best_imitation(marks, columns)[0]
    begin = as_soft(model)
    if gain >= DECIDABLE and (begin.any() or gain < NEARLY * 0.5 * float(marks @ marks)):
        gain = min(gain, left_by_the_best(model, starts, begin, DECIDABLE))
    return Insight(gain, residual, dict(zip(NAMES, solution.tolist(), strict=True)), beyond)


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


def _telling_windows(case: Case, truth: Mapping[str, Array], kept: Sequence[Effect]) -> list[int]:
    """First samples of the windows in which leaving the effect out matters most."""
    samples = length(case)
    candidates = list(range(0, len(truth["time"]) - samples, samples))
    energies = [float(np.sum(_mark(case, truth, first, kept) ** 2)) for first in candidates]
    order = np.argsort(energies)[::-1][:WINDOWS]
    return sorted(candidates[i] for i in order)


def _mark(case: Case, truth: Mapping[str, Array], first: int, kept: Sequence[Effect]) -> Array:
    last = first + length(case)
    there = {name: column[first : last + 1] for name, column in truth.items()}
    return scaled(case, there) - scaled(case, resume_truth(case.plant, kept, truth, first, last))
