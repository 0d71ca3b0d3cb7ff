"""Recordings with a mistake or a fault, and sound ones: found, and let pass."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from eha_core.health import Fault, examine, unsuited
from eha_core.plant import PAPER
from eha_core.plausibility import check
from eha_core.recording import Recording
from tools.hostile.extent import Extent
from tools.hostile.faulty_recordings import EVERY, FAULTS, FaultKind, faulty, verdict
from tools.hostile.row import Row
from tools.hostile.sound_recordings import Sound, sound_recordings
from tools.hostile.wrong_recordings import as_recording, kinds, make_wrong, rigs

MOST_RECORDINGS = 500
"""Sound recordings that a trial checks at most unless it is given how many; of another number, they are others."""
MADE_IN = 5
"""Of so many sound recordings one has faults made in it."""
MOST_RIGS = 500
"""Rigs that a trial makes mistakes in at most."""


def try_sound(extent: Extent, seed: int) -> list[Row]:
    """Check sound recordings of every kind."""
    row = Row("sound recordings of simulated rigs checked", seed)
    course = extent.begin()
    for sound in sound_recordings(seed, extent.times or MOST_RECORDINGS):
        if course.over(row.times):
            break
        finding = check(sound.recording, sound.nominal)
        if finding:
            row.fail(f"{sound.case} of seed {seed}, {sound.kind}, {', '.join(sound.recording.channels)}: {finding}")
        else:
            row.count(f"let pass {sound.kind}")
    return [row]


def try_mistakes(extent: Extent, seed: int) -> list[Row]:
    """Check recordings with every kind of mistake, of as many rigs as there is time for."""
    row = Row(f"recordings with one of {len(list(kinds()))} kinds of mistakes checked", seed)
    course = extent.begin()
    whole = (rig for rig in rigs(seed, MOST_RIGS) if len(rig.case.channels) == 4)
    for other, rig in pairwise(whole):
        for mistake, without in kinds():
            if course.over(row.times):
                return [row]
            finding = check(make_wrong(mistake, rig, other, without), rig.nominal)
            if finding is None:
                row.count("not found")
            elif mistake.expected in str(finding):
                row.count("found")
            else:
                row.fail(f"{rig.case.name} of seed {seed}, {mistake.name} without {without}: {finding}")
    return [row]


def try_faults(extent: Extent, seed: int) -> list[Row]:
    """Look for faults in sound recordings, and in the same with every kind of fault; a row for each kind.

    `extent.times` counts the sound recordings; one in five of them has every kind made in it, where it has every
    channel.
    """
    passed = Row("sound recordings of seven kinds, every channel examined", seed)
    rows = {kind: Row(f"{kind.name}: {kind.channel}", seed) for kind in FAULTS}
    course = extent.begin()
    for number, sound in enumerate(sound_recordings(seed, extent.times or MOST_RECORDINGS)):
        if course.over(passed.times):
            break
        faults = _faults(sound.recording, sound.nominal)
        if not faults:
            passed.count("let pass")
        else:
            passed.fail(f"{sound.case} of seed {seed}, {sound.kind}: {faults[0].channel} {faults[0].seen}")
        if number % MADE_IN == 0 and not faults and all(name in sound.recording.channels for name in EVERY):
            _make_each(sound, rows, seed, number)
    return [passed, *rows.values()]


def _make_each(sound: Sound, rows: Mapping[FaultKind, Row], seed: int, number: int) -> None:
    arrays = {name: (channel.time, channel.values) for name, channel in sound.recording.channels.items()}
    for kind, row in rows.items():
        made, spans = faulty(kind, arrays, 1000 * seed + number)
        row.count(verdict(kind, _faults(as_recording(made), sound.nominal), spans, arrays[kind.channel][0]))


def _faults(recording: Recording, nominal: Mapping[str, float]) -> tuple[Fault, ...]:
    return (*examine(recording).faults, *unsuited(recording, nominal, PAPER))
