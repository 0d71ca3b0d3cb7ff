"""The model that was found, held against the whole record block by block: its parameters stay as they are."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from eha_core.diagnosis.result import JudgedBlock, LongRecord
from eha_core.errors import RecordingError
from eha_core.identification.fit import fit
from eha_core.identification.observation import Observation, observe
from eha_core.identification.problem import whole
from eha_core.identification.segments import cut
from eha_core.long_record.limits import DEPARTS, ITERATIONS, WINDOW
from eha_core.plant import Composition
from eha_core.quantities import quantity
from eha_core.recording import CHANNEL_KINDS
from eha_core.recording.blocks import Block

STEP = 2e-4
"""s; the step of the search."""


class Judge:
    """Takes blocks and keeps what two models err by in each."""

    def __init__(
        self,
        nominal: Mapping[str, float],
        found: Mapping[str, float],
        composition: Composition,
        fitted: Collection[int],
    ) -> None:
        self.blocks: list[JudgedBlock] = []
        self.passed_over = 0.0
        self._models = (nominal, found)
        self._composition, self._fitted = composition, fitted

    def take(self, block: Block) -> None:
        """Judge one block, or pass it over where nothing can be compared, as of a rig at rest."""
        try:
            observation = observe(block.recording, self._composition) if block.recording else None
        except RecordingError:
            observation = None
        if observation is None:
            self.passed_over += block.end - block.start
            return
        before, after = (errors_held(observation, values) for values in self._models)
        self.blocks.append(JudgedBlock(block.start, block.end, block.number in self._fitted, before, after))


def errors_held(observation: Observation, values: Mapping[str, float]) -> dict[str, float]:
    """RMSE of every channel [its unit] with the parameters held, and the state fitted at the start of every window."""
    shooting = cut(observation, values, STEP, WINDOW)
    found = fit(whole(shooting), values, (), iterations=ITERATIONS)
    triples = zip(shooting.names, shooting.samplings, found.residuals, strict=True)
    return {name: float(np.sqrt(np.mean(residual**2))) * sampling.noise for name, sampling, residual in triples}


def long_record(path: str, duration: float, stretches: Sequence[tuple[float, float]], judge: Judge) -> LongRecord:
    """What the judged blocks say of a record."""
    departs = _departing(judge.blocks)
    said = _stated(duration, stretches, judge.blocks, departs)
    return LongRecord(path, duration, tuple(stretches), WINDOW, tuple(judge.blocks), judge.passed_over, departs, said)


def _departing(blocks: Sequence[JudgedBlock]) -> tuple[tuple[float, float], ...]:
    """Spans of time in which the model errs by far more than on any stretch that it was fitted to."""
    fitted = [block for block in blocks if block.fitted]
    if not fitted:
        return ()
    most = {
        name: DEPARTS * max(block.after[name] for block in fitted if name in block.after) for name in fitted[0].after
    }
    spans: list[tuple[float, float]] = []
    for block in blocks:
        if not any(block.after[name] > most[name] for name in block.after if name in most):
            continue
        touching = spans and block.start - spans[-1][1] < 1e-6
        spans = [*spans[:-1], (spans[-1][0], block.end)] if touching else [*spans, (block.start, block.end)]
    return tuple(spans)


def _stated(
    duration: float,
    stretches: Sequence[tuple[float, float]],
    blocks: Sequence[JudgedBlock],
    departs: Sequence[tuple[float, float]],
) -> str:
    length = stretches[0][1] - stretches[0][0]
    said = f"Of {duration:.0f} s, {len(stretches)} stretches of {length:.0f} s were fitted."
    unseen, fitted = ([block for block in blocks if block.fitted is seen] for seen in (False, True))
    if not unseen or not fitted:
        return said
    name = "position" if "position" in fitted[0].after else next(iter(fitted[0].after))
    unit = CHANNEL_KINDS[name].unit
    after, nominal, own = (
        quantity(float(np.median(values)), unit)
        for values in (
            [block.after[name] for block in unseen],
            [block.before[name] for block in unseen],
            [block.after[name] for block in fitted],
        )
    )
    said += (
        f" With its parameters held, the model errs by {after} in {name.replace('_', ' ')} over the"
        f" {sum(block.end - block.start for block in unseen):.0f} s that were not fitted, and by {own} over those that"
        f" were (medians of blocks; the nominal model: {nominal})"
    )
    if not departs:
        return f"{said}; from the first to the last block, nowhere by {DEPARTS:g} times what it does on these."
    listed = ", ".join(f"{start:.0f} to {end:.0f} s" for start, end in departs[:4])
    more = f" and {len(departs) - 4} more spans" if len(departs) > 4 else ""
    return (
        f"{said}; from {listed}{more} it errs by more than {DEPARTS:g} times what it does on these: what acts there is"
        " not in the model."
    )
