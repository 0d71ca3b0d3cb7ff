"""Over short windows: a set grown where the objective is smooth, and then led to long windows.

Where much is missing, a fit over long windows rests wherever the piston breaks away too early or too late, and the next
effect compensates for that. Over 0.1 s nothing can go far another way than measured, so what is missing shows itself.
"""

from __future__ import annotations

from dataclasses import replace

from eha_core.diagnosis.criteria import UNFITTED
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.candidates import Candidate, Search
from eha_core.diagnosis.search.grow import grow
from eha_core.diagnosis.search.settle import settle
from eha_core.diagnosis.search.short_windows import at_nominal
from eha_core.identification.fit import fit
from eha_core.identification.problem import whole
from eha_core.identification.short_windows import ITERATIONS, held, starts, to_long_windows


def grown_over_short_windows(search: Search, nominal: Candidate) -> Candidate:
    """The best so far when a set was grown over short windows from the nominal values, and led to long ones.

    Where that leaves more than noise, once more over the shortest, in which friction finds its law; and then with the
    nominal values held near what was given: what is free takes the place of what is missing, but a value that is far
    off needs to move.
    """
    free = nominal.fit.free
    values = at_nominal(nominal.fit.values, free)
    as_free = {parameter.name: parameter for parameter in free}
    attempts = ((search.shorter, free), (search.shortest, free), (search.shorter, held(free, values)))
    for shorter, believed in attempts:
        problem = whole(shorter[0])
        nothing = fit(problem, values, believed, starts(problem, values), iterations=ITERATIONS)
        found = {NOTHING: nothing}
        scout = replace(search, problem=problem, found=found, shorter=shorter[:1], short=True)
        grown = settle(scout, grow(scout, Candidate(NOTHING, nothing)))
        if grown.hypothesis != NOTHING:
            moved = tuple(as_free.get(parameter.name, parameter) for parameter in grown.fit.free)
            search.keep(grown.hypothesis, to_long_windows(search.problem, shorter, grown.fit.values, moved))
        best = search.best
        if not search.leaves(best, UNFITTED):
            break
    return best
