"""Converts samples to the model's units, and refuses numbers that must be in others."""

from __future__ import annotations

import numpy as np

from eha_core.errors import RecordingError
from eha_core.recording.channel_kinds import CHANNEL_KINDS
from eha_core.recording.channel_rules import ABSOLUTE, GAUGE, ChannelRule
from eha_core.recording.samples import Samples

_LEAST_PRESSURE = {ABSOLUTE: 2e4, GAUGE: 1e3}
"""A pressure channel that never exceeds this [Pa] is in bar or MPa."""

_UNITS = {
    "Pa": {"bar": "1.0e5", "MPa": "1.0e6", "kPa": "1.0e3", "psi": "6894.757"},
    "m": {"mm": "1.0e-3", "um": "1.0e-6"},
}
_USUAL = {"Pa": (1e6, 5e7), "m": (1e-3, 5.0)}
"""Usual ranges on rigs, by unit; only a message depends on them."""

_MOST_OUTLIERS = 0.01
"""Largest share of impossible samples that counts as outliers; above it, the unit is another."""


def in_model_units(
    where: str, name: str, rule: ChannelRule, samples: Samples, atmosphere: float
) -> tuple[Samples, tuple[str, ...]]:
    """The samples in SI, pressures as gauge, and remarks on what was excluded or assumed.

    Raises:
        RecordingError: the numbers cannot be in the stated unit.
    """
    kind = CHANNEL_KINDS[name]
    values = rule.in_si(samples.values)
    reference = rule.reference or ABSOLUTE
    impossible = np.abs(values) > kind.largest
    largest = float(np.max(np.abs(values)))
    too_small = kind.is_pressure and 0.0 < largest < _LEAST_PRESSURE[reference]
    if np.mean(impossible) > _MOST_OUTLIERS or too_small:
        raise RecordingError(
            f"{where} reaches {largest:.4g} {kind.unit} at most, which is not plausible for a rig; give its `scale`"
            f" to {kind.unit} in a topics file{_likely_units(name, largest)}"
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


def _likely_units(name: str, largest: float) -> str:
    """The topics files that scale the channel into the usual range of rigs, if its unit has one."""
    low, high = _USUAL.get(CHANNEL_KINDS[name].unit, (1.0, 0.0))
    units = [
        f"`channels: {{{name}: {{scale: {scale}}}}}` if it is in {unit}"
        for unit, scale in _UNITS.get(CHANNEL_KINDS[name].unit, {}).items()
        if low <= largest * float(scale) <= high
    ]
    return f": {', '.join(units)}" if units else ""
