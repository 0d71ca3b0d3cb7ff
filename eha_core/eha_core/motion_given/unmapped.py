"""Columns of a table that no channel uses and that the residual of a law depends on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from eha_core.motion_given.law import Law, blocks_of, columns_of, predict, solve
from eha_core.motion_given.motion import Array, Motion
from eha_core.motion_given.search import WORTH
from eha_core.recording import Recording
from eha_core.tables import is_table, read_table

ALIKE = 0.7
"""Correlation with the force or the motion from which on a column is taken as another recording of them (assumed)."""


def unmapped_columns(recordings: Sequence[Recording], motions: Sequence[Motion], law: Law) -> list[str]:
    """A remark on the unused column that explains most of the residual on blocks that were not fitted, if it is enough.

    It is asked whether the sizes of the law's terms change in proportion to the column, or the force does.
    """
    if not law.terms or any(motion.schedule is not None for motion in motions):
        return []
    tables = [dict(_columns(recording, motion)) for recording, motion in zip(recordings, motions, strict=True)]
    shared = [name for name in tables[0] if all(name in table for table in tables)]
    explained = {name: _explained(motions, [table[name] for table in tables], law) for name in shared}
    best = max(explained, key=lambda name: explained[name], default=None)
    if best is None or explained[best] < WORTH:
        return []
    return [
        f"column {best!r} explains {100 * explained[best]:.0f} % of the squared residual; if it is a condition of the"
        f' rig, map it in the topics file as schedule: {{column: "{best}"}}'
    ]


def _columns(recording: Recording, motion: Motion) -> Iterator[tuple[str, Array]]:
    """The unused columns of a recording's table on the motion's time axis."""
    if not (recording.path.is_file() and is_table(recording.path)):
        return
    stamps = recording.channels["force" if "force" in recording.channels else "pressure_a"].time
    rules = [channel.rule for channel in recording.channels.values() if channel.rule is not None]
    used = {name for rule in rules for name in (rule.column, rule.minus, rule.time)}
    for name, column in read_table(recording.path).columns.items():
        if name in used or len(column) != len(stamps) or column.dtype.kind not in "fiu":
            continue
        values = np.interp(motion.time, stamps, column.astype(np.float64))
        if np.all(np.isfinite(values)) and not _counts(values) and not _alike(values, motion):
            yield name, values


def _counts(values: Array) -> bool:
    """Whether the values are a time or the numbers of the rows."""
    return bool(np.all(np.diff(values) > 0.0))


def _alike(values: Array, motion: Motion) -> bool:
    known = (motion.force, motion.position, motion.velocity, motion.acceleration)
    varies = float(np.ptp(values)) > 0.0
    return varies and any(float(abs(np.corrcoef(values, one)[0, 1])) >= ALIKE for one in known)


def _explained(motions: Sequence[Motion], columns: Sequence[Array], law: Law) -> float:
    """Share of the squared residual of the held-out blocks that the column explains."""
    middle = float(np.mean(np.concatenate(columns)))
    spread = float(np.std(np.concatenate(columns)))
    if not spread > 0.0:
        return 0.0
    regressors, residual, held_out = [], [], []
    for motion, column in zip(motions, columns, strict=True):
        rows, block = blocks_of(motion)
        own = columns_of(law.terms, motion, law.shape, rows)
        with_steady = np.concatenate([own, np.ones((len(rows), 1))], axis=1)
        regressors.append(with_steady * ((column[rows] - middle) / spread)[:, None])
        residual.append((motion.force - predict(law, motion))[rows])
        held_out.append(block % 3 == 1)
    slopes, left, out = np.concatenate(regressors), np.concatenate(residual), np.concatenate(held_out)
    sizes = solve(slopes[~out], left[~out])
    return 1.0 - float(np.mean((left - slopes @ sizes)[out] ** 2) / np.mean(left[out] ** 2))
