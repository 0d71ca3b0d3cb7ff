"""The way out of a diagnosis of long records: told in the record's time, and judged by the whole of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eha_core.diagnosis.result import Diagnosis, LongRecord
from eha_core.long_record.admission import Admitted, Progress
from eha_core.long_record.in_its_time import in_time_of_record
from eha_core.long_record.judge import Judge, long_record
from eha_core.nominal import NominalModel
from eha_core.recording.blocks import Block


def judged(
    diagnosis: Diagnosis, records: Sequence[Admitted], model: NominalModel, progress: Progress = lambda _: None
) -> Diagnosis:
    """The diagnosis with times of the record that its stretches are from, and with what whole records say of its model.

    Without a long record among `records` it is the diagnosis as given.
    """
    long = [one for one in records if one.blocks is not None]
    if not long:
        return diagnosis
    composition = model.composition
    found = {**composition.places(composition.nominal_values()), **diagnosis.fitted_values}
    told = [_judged(one, model, found, progress) for one in long]
    remarks = [remark for one in long if one.blocks for remark in one.blocks.remarks]
    damaged = next((one.blocks.damaged for one in long if one.blocks and one.blocks.damaged), diagnosis.damaged)
    stretches = [(one.path, one.blocks.duration, one.recordings, one.spans) for one in long if one.blocks]
    diagnosis = in_time_of_record(diagnosis, stretches)
    return replace(
        diagnosis,
        remarks=tuple(dict.fromkeys((*remarks, *diagnosis.remarks))),
        damaged=damaged,
        long_records=tuple(told),
    )


def _judged(one: Admitted, model: NominalModel, found: Mapping[str, float], progress: Progress) -> LongRecord:
    assert one.blocks is not None
    judge = Judge(model.values, found, model.composition, one.chosen)

    def take(block: Block) -> None:
        judge.take(block)
        progress(f"judging the model on the whole of {one.path.name}: {block.end:.0f} of {duration:.0f} s")

    duration = one.blocks.duration
    one.blocks.each(take)
    return long_record(str(one.path), duration, one.spans, judge)
