"""Brings samples to the model's units, and refuses numbers that can only be in others."""

from __future__ import annotations

import numpy as np

from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import ABSOLUTE, GAUGE, ChannelRule
from eha_core.recording.recording import CHANNEL_KINDS
from eha_core.recording.samples import Samples

_LEAST_PRESSURE = {ABSOLUTE: 2e4, GAUGE: 1e3}
"""A pressure channel that never exceeds this [Pa] is in bar or MPa."""

_MOST_OUTLIERS = 0.01
"""A larger share of impossible samples is no run of outliers but another unit."""


def in_model_units(
    where: str, name: str, rule: ChannelRule, samples: Samples, atmosphere: float
) -> tuple[Samples, tuple[str, ...]]:
    """Scale to SI and pressures to gauge; also say what was left out or assumed.

    Raises:
        RecordingError: the numbers cannot be in the unit that was said.
    """
    kind = CHANNEL_KINDS[name]
    values = samples.values * rule.scale + rule.offset
    reference = rule.reference or ABSOLUTE
    impossible = np.abs(values) > kind.largest
    largest = float(np.max(np.abs(values)))
    too_small = kind.is_pressure and 0.0 < largest < _LEAST_PRESSURE[reference]
    if np.mean(impossible) > _MOST_OUTLIERS or too_small:
        raise RecordingError(
            f"{where} reaches {largest:.4g} {kind.unit} at most, which is no rig's;"
            f" if it is in another unit give its `scale` to {kind.unit} in a topics file"
        )
    notes = []
    if impossible.any():
        notes.append(f"{np.count_nonzero(impossible)} samples beyond {kind.largest:g} {kind.unit} were left out")
    stamps, values = samples.stamps[~impossible], values[~impossible]
    if kind.is_pressure and reference != GAUGE:
        if float(np.median(values)) < 0.0:
            raise RecordingError(
                f"{where} is mostly negative, which an absolute pressure cannot be;"
                " say `reference: gauge` in a topics file"
            )
        values = values - atmosphere
        if rule.reference is None:
            notes.append("taken as absolute pressure; a topics file can say otherwise")
    return Samples(stamps, values), tuple(notes)
