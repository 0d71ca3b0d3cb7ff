"""Recordings with a fault of their own, diagnosed as a user would: no physics is named from a fault, and what a rig
lacks is found in spite of it."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence

from eha_core.diagnosis import diagnose_together
from eha_core.errors import EhaError
from eha_core.exam.case import Case
from eha_core.exam.drawing import draw_case
from eha_core.exam.scoring import accepted
from eha_core.nominal import NominalModel
from eha_core.plausibility import admit
from tools.hostile.extent import Extent
from tools.hostile.faulty_recordings import FAULTS, FaultKind, faulty
from tools.hostile.row import Row
from tools.hostile.wrong_recordings import as_recording, make_rig

NOTHING_MISSING = ("null", "null_parameters")
"""The exam's tiers of rigs as modelled: with the nominal parameters, and with others."""
SOMETHING_MISSING = ("single", "pair")
"""The exam's tiers of rigs with one effect and with two."""
MOST = 500
"""Recordings that a trial makes at most."""


def try_named(extent: Extent, seed: int) -> list[Row]:
    """Diagnose rigs that lack nothing, with each kind of fault in turn: a row for each kind."""
    rows = {kind: Row(f"diagnosed, nothing missing, {kind.name}: {kind.channel}", seed) for kind in FAULTS}
    for case, kind, (verdict, named) in _diagnosed(extent, seed, NOTHING_MISSING, FAULTS):
        if verdict in ("consistent", "parameters", "refused"):
            rows[kind].count("refused" if verdict == "refused" else "nothing named")
        elif named and set(named) <= set(kind.effects):
            rows[kind].count("named as what it is")
        else:
            rows[kind].fail(f"{case.name} of seed {seed}, {kind.name}: {verdict} {' + '.join(named)}")
    return list(rows.values())


def try_planted(extent: Extent, seed: int) -> list[Row]:
    """Diagnose rigs that lack one or two effects, with each kind of fault in turn that leaves something to compare."""
    kinds = [kind for kind in FAULTS if not kind.refused]
    row = Row(f"diagnosed, one effect or two missing, {len(kinds)} kinds of faults", seed)
    for case, kind, (verdict, named) in _diagnosed(extent, seed, SOMETHING_MISSING, kinds):
        own = {*accepted(case)[0], *kind.effects}
        if verdict == "missing_physics" and set(named) in accepted(case):
            row.count("exactly what is missing")
        elif verdict == "refused":
            row.count("refused")
        elif verdict in ("consistent", "parameters"):
            row.count("nothing named")
        elif verdict == "ambiguous":
            row.count("several explanations")
        elif verdict == "unknown_physics" and not named:
            row.count("no name")
        elif set(named) <= own:
            row.count("some of what is missing")
        else:
            row.count("another effect")
            print(f"{case.name}: {' + '.join(case.effect_ids)}", file=sys.stderr)
    return [row]


def _diagnosed(
    extent: Extent, seed: int, tiers: Sequence[str], kinds: Sequence[FaultKind]
) -> Iterator[tuple[Case, FaultKind, tuple[str, tuple[str, ...]]]]:
    """A new rig for each recording and the next kind of fault in it; the verdict, or "refused", and what is named."""
    course = extent.begin()
    for number in range(extent.first, extent.first + (extent.times or MOST)):
        if course.over(number - extent.first):
            return
        case = draw_case(tiers[number // len(kinds) % len(tiers)], number, seed)
        kind, begun = kinds[number % len(kinds)], time.process_time()
        found = _found(case, kind, 1000 * seed + number)
        spent = time.process_time() - begun
        print(f"{number} {case.name} {kind.name}: {found[0]} {' + '.join(found[1])}, {spent:.0f} s", file=sys.stderr)
        yield case, kind, found


def _found(case: Case, kind: FaultKind, seed: int) -> tuple[str, tuple[str, ...]]:
    rig = make_rig(case)
    arrays = {name: rig.arrays[name] for name in case.channels}
    recording = as_recording(faulty(kind, arrays, seed)[0])
    try:
        recording = admit(recording, rig.nominal)
        found = diagnose_together([recording], NominalModel(rig.nominal), jobs=1)
    except EhaError:
        return "refused", ()
    return found.verdict, tuple(effect.id for effect in found.effects)
