"""The way out of a diagnosis of long records: in the record's time, and judged by the whole of it."""

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
    long = [record for record in records if record.blocks is not None]
    if not long:
        return diagnosis
    composition = model.composition
    found = {**composition.places(composition.nominal_values()), **diagnosis.fitted_values}
    judgements = [_judged(record, model, found, progress) for record in long]
    remarks = [remark for record in long if record.blocks for remark in record.blocks.remarks]
    damaged = next(
        (record.blocks.damaged for record in long if record.blocks and record.blocks.damaged), diagnosis.damaged
    )
    stretches = [
        (record.path, record.blocks.duration, record.recordings, record.spans) for record in long if record.blocks
    ]
    diagnosis = in_time_of_record(diagnosis, stretches)
    return replace(
        diagnosis,
        remarks=tuple(dict.fromkeys((*remarks, *diagnosis.remarks))),
        damaged=damaged,
        long_records=tuple(judgements),
    )


def _judged(record: Admitted, model: NominalModel, found: Mapping[str, float], progress: Progress) -> LongRecord:
    assert record.blocks is not None
    judge = Judge(model.values, found, model.composition, record.chosen)

    def take(block: Block) -> None:
        judge.take(block)
        progress(f"judging the model on the whole of {record.path.name}: {block.end:.0f} of {duration:.0f} s")

    duration = record.blocks.duration
    record.blocks.each(take)
    return long_record(str(record.path), duration, record.spans, judge)
