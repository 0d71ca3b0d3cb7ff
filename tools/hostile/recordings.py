"""Recordings with a mistake, and sound ones: told, and let pass."""

from __future__ import annotations

from itertools import pairwise

from eha_core.plausibility import check
from tools.hostile.extent import Extent
from tools.hostile.row import Row
from tools.hostile.sound_recordings import sound_recordings
from tools.hostile.wrong_recordings import kinds, make_wrong, rigs

MOST_RECORDINGS = 500
"""Sound recordings that a trial checks at most where it is not told how many; of another number, they are others."""
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
                row.count("not told")
            elif mistake.told in str(finding):
                row.count("told")
            else:
                row.fail(f"{rig.case.name} of seed {seed}, {mistake.name} without {without}: {finding}")
    return [row]
