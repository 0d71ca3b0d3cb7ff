"""Recordings with a fault of their own, diagnosed as a user would: no physics is named from a fault, and what a rig
lacks is found in spite of it."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Mapping, Sequence

from eha_core.diagnosis import diagnose_together
from eha_core.errors import EhaError
from eha_core.nominal import NominalModel
from eha_core.plausibility import admit
from eha_exam.case import Case
from eha_exam.drawing import draw_case
from eha_exam.scoring import accepted
from tools.hostile.extent import Extent
from tools.hostile.faulty_recordings import FAULTS, FaultKind, faulty
from tools.hostile.row import Row
from tools.hostile.wrong_recordings import Arrays, as_recording, make_rig

NOTHING_MISSING = ("null", "null_parameters")
"""The exam's tiers of rigs as modelled: with the nominal parameters, and with others."""
SOMETHING_MISSING = ("single", "pair")
"""The exam's tiers of rigs with one effect and with two."""
UNDECIDED = "undecided"
"""In place of a verdict: what is missing is not named exactly of the recording without a fault."""
MOST = 500
"""Recordings that a trial makes at most."""

Answer = tuple[str, tuple[str, ...]]
"""A verdict and the effects that are named."""


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
    """Diagnose rigs that lack one or two effects, with each kind of fault in turn that leaves something to compare,
    where what is missing is named exactly without the fault."""
    kinds = [kind for kind in FAULTS if not kind.refused]
    row = Row(f"diagnosed, one effect or two missing, {len(kinds)} kinds of faults", seed)
    for case, kind, (verdict, named) in _diagnosed(extent, seed, SOMETHING_MISSING, kinds):
        row.count(_outcome(case, kind, verdict, set(named)))
    return [row]


def _outcome(case: Case, kind: FaultKind, verdict: str, named: set[str]) -> str:
    if verdict == "refused":
        return "refused"
    if verdict == UNDECIDED:
        return "not exact without a fault either"
    if verdict == "missing_physics" and named in accepted(case):
        return "exactly what is missing"
    if verdict == "missing_physics" and named - set(kind.effects) in accepted(case):
        return "what is missing and the fault's own name"
    if verdict in ("ambiguous", "unknown_physics"):
        return "no name that is sure"
    return "less than what is missing" if named < accepted(case)[0] else "another effect"


def _diagnosed(
    extent: Extent, seed: int, tiers: Sequence[str], kinds: Sequence[FaultKind]
) -> Iterator[tuple[Case, FaultKind, Answer]]:
    """A new rig for each recording and the next kind of fault in it; the verdict, or "refused", and what is named."""
    course = extent.begin()
    for number in range(extent.first, extent.first + (extent.times or MOST)):
        if course.over(number - extent.first):
            return
        case = draw_case(tiers[number // len(kinds) % len(tiers)], number, seed)
        kind, begun = kinds[number % len(kinds)], time.process_time()
        verdict, named = _found(case, kind, 1000 * seed + number)
        spent = time.process_time() - begun
        missing = " + ".join(case.effect_ids)
        line = f"{number} {case.name} {missing}, {kind.name}: {verdict} {' + '.join(named)}, {spent:.0f} s"
        print(line, file=sys.stderr)
        yield case, kind, (verdict, named)


def _found(case: Case, kind: FaultKind, seed: int) -> Answer:
    rig = make_rig(case)
    arrays = {name: rig.arrays[name] for name in case.channels}
    if case.effects:
        verdict, named = _answer(arrays, rig.nominal)
        if verdict != "missing_physics" or set(named) not in accepted(case):
            return UNDECIDED, named
    return _answer(faulty(kind, arrays, seed)[0], rig.nominal)


def _answer(arrays: Arrays, nominal: Mapping[str, float]) -> Answer:
    try:
        recording = admit(as_recording(arrays), nominal)
        found = diagnose_together([recording], NominalModel(nominal), jobs=1)
    except EhaError:
        return "refused", ()
    return found.verdict, tuple(effect.id for effect in found.effects)
