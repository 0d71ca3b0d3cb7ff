"""From records to the figures of each step and of each direction."""

from __future__ import annotations

from collections.abc import Sequence

from eha_core.errors import EhaError
from eha_core.step_tests.commanded import commanded_steps
from eha_core.step_tests.one_step import least_variance, read_step
from eha_core.step_tests.result import Record, Step, StepTests
from eha_core.step_tests.together import directions_of


def read_steps(records: Sequence[Record]) -> StepTests:
    """Read the steps of all records as one experiment; their units must be alike.

    Raises:
        EhaError: no record has a usable step.
    """
    steps: list[Step] = []
    remarks: list[str] = []
    least = least_variance(records)
    for record in records:
        remarks += [f"{record.source}: {remark}" for remark in record.remarks]
        found, said = commanded_steps(record)
        remarks += said
        for one in found:
            step = read_step(record, one, least)
            if isinstance(step, str):
                remarks.append(f"{record.source}, at {one.on:.2f} s: {step}")
            else:
                steps.append(step)
    if not steps:
        raise EhaError(f"no step of the command can be used: {remarks[-1]}")
    first = records[0]
    known, directions = directions_of(steps, first.is_velocity)
    return StepTests(
        tuple(known), tuple(directions), first.command_unit, first.motion_unit, first.is_velocity, tuple(remarks)
    )
