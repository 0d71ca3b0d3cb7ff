"""Recordings with a mistake, and sound ones: told, and let pass."""

from __future__ import annotations

from itertools import pairwise

from eha_core.plausibility import check
from tools.hostile.extent import Extent
from tools.hostile.row import Row
from tools.hostile.wrong_recordings import SUBSETS, as_recording, kinds, make_wrong, rigs

MOST_RIGS = 500
"""Rigs that a trial checks at most; a longer one would repeat what it says."""


def try_sound(extent: Extent, seed: int) -> list[Row]:
    """Check the sound recordings of as many rigs as there is time for."""
    row = Row("sound recordings of simulated rigs checked", seed)
    course = extent.begin()
    for rig in rigs(seed, MOST_RIGS):
        if course.over(row.times):
            break
        lacking = SUBSETS[row.times % len(SUBSETS)]
        arrays = {name: pair for name, pair in rig.arrays.items() if name not in lacking}
        finding = check(as_recording(arrays), rig.nominal)
        row.fail(f"{rig.case.name} of seed {seed}: {finding}") if finding else row.count("let pass")
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
