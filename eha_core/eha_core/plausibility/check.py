"""The check: which single mistake, if any, explains an implausible recording."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from eha_core.errors import RecordingError
from eha_core.health import examine, in_words, unsuited
from eha_core.plant import PAPER, Composition
from eha_core.plausibility.copies import copies, noisy_copies
from eha_core.plausibility.finding import Finding, Suspect
from eha_core.plausibility.mistakes import suspects, unrelated
from eha_core.plausibility.other_source import contradiction
from eha_core.plausibility.relation import Relation
from eha_core.plausibility.relations import LOW, relations
from eha_core.recording import Recording

CLOSER = 1.0
"""Difference of the distances (logarithms: a factor of 2.7 in scale) by which one mistake must be better than another
to be reported alone: a valve's gain may be off by 2, and inches for cm is a factor of 2.5."""


def check(recording: Recording, nominal: Mapping[str, float], composition: Composition = PAPER) -> Finding | None:
    """The mistake that was made in a recording; None where it is sound, or no single mistake explains it.

    A recording is suspected only if it certainly violates a relation that holds for every actuator of the nominal kind,
    whatever physics is missing; and a mistake is reported only if correcting it makes every check pass.

    Args:
        recording: as it was read.
        nominal: every parameter's nominal value by name [SI].
        composition: the actuator's parts.
    """
    if copy := copies(recording):
        return Finding(copy.mistake, copy.cure)
    found = relations(recording, nominal, composition)
    noisy = noisy_copies(recording, nominal) if not _pressures_are_low(found) else None
    if not any(relation.broken for relation in found.values()):
        return Finding(noisy.mistake, noisy.cure) if noisy else None
    cured = _cured(found, recording, suspects(recording, nominal), nominal, composition)
    cured = cured or _cured(found, recording, [noisy] if noisy else [], nominal, composition)
    cured = cured or _cured(found, recording, unrelated(recording, nominal), nominal, composition)
    if not cured:
        return None
    least = min(distance for distance, _ in cured)
    likely, *others = [suspect for distance, suspect in cured if distance < least + CLOSER]
    return Finding(likely.mistake, likely.cure, (others[0].mistake, others[0].cure) if others else None)


def admit(
    recording: Recording,
    nominal: Mapping[str, float],
    as_recorded: bool = False,
    composition: Composition = PAPER,
    switch: str = "--as-recorded",
) -> Recording:
    """The recording, if it is plausible; with `as_recorded` in any case, with a warning as its first remark.

    switch: the caller's option for that, as an error names it.

    Raises:
        RecordingError: a mistake was made in the recording, a channel has a fault that makes it useless, or the
            channels contradict the plant's source; the message says which, and the remedy.
    """
    health = examine(recording)
    ill = [fault for fault in (*health.faults, *unsuited(recording, nominal, composition)) if fault.refuses]
    sound = health.without_faults(recording)
    finding = "; ".join(in_words(ill)) or contradiction(sound, composition) or check(sound, nominal, composition)
    if not finding:
        return recording
    if not as_recorded:
        raise RecordingError(f"{recording.path}: {finding}; {switch} continues all the same")
    warning = f"warning: taken as recorded, although {finding}"
    return replace(recording, remarks=(warning, *recording.remarks))


def _cured(
    found: Mapping[str, Relation],
    recording: Recording,
    possible: Iterable[Suspect],
    nominal: Mapping[str, float],
    composition: Composition,
) -> list[tuple[float, Suspect]]:
    """The mistakes whose correction makes every check pass, each with the corrected recording's total distance."""
    cured = []
    for suspect in possible:
        without = relations(suspect.without(recording), nominal, composition)
        if without and _mends(found, without):
            cured.append((sum(relation.distance for relation in without.values()), suspect))
    return cured


def _mends(found: Mapping[str, Relation], without: Mapping[str, Relation]) -> bool:
    """Whether no relation is broken, and each that was certain before is sound or can no longer be computed."""
    judged = [relation for name, relation in without.items() if name in found and _is_certain(found[name])]
    return all(relation.sound for relation in judged) and not any(relation.broken for relation in without.values())


def _pressures_are_low(found: Mapping[str, Relation]) -> bool:
    """Whether both pressures are so low that they may have another unit, in which their difference looks like noise."""
    return "level" in found and found["level"].value < LOW


def _is_certain(relation: Relation) -> bool:
    return relation.broken or relation.sound
