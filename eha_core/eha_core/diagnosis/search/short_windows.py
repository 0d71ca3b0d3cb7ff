"""Short windows first: laws of friction that stick are led to their optimum, which long windows hide.

Where everything is far from the noise, each form of dry friction is fitted by itself from short windows to long ones,
and so is the best set if it has one; what they find is compared with all else.
"""

from __future__ import annotations

from collections.abc import Mapping

from eha_core.diagnosis.hypotheses import starts
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.candidates import Candidate, Search, with_effects
from eha_core.effects import Effect
from eha_core.identification.freedom import Free
from eha_core.identification.per_recording import base_name
from eha_core.identification.short_windows import from_short_windows

STICKING = "dry friction"
"""The kind of law that can hold the piston at rest."""


def forms_of_friction(search: Search, nominal: Candidate) -> Candidate:
    """The best so far when each form of dry friction was led from short windows to long ones, from nominal values."""
    for effect in (one for one in search.able if _sticks(one)):
        search.progress(f"fitting {effect.id} from short windows to long ones")
        values = {**_at_nominal(nominal.fit.values, nominal.fit.free), **starts(effect, search.facts)[-1].values}
        free = with_effects(nominal.fit.free, [effect], values)
        found = from_short_windows(search.problem, search.shorter, values, free)
        search.keep(NOTHING.with_effects([effect]), found)
    return min(search, key=lambda one: one.fit.objective)


def set_with_friction(search: Search, best: Candidate) -> Candidate:
    """A set with a law that sticks, led from short windows to long ones; the set as it is where it has none."""
    if not any(_sticks(effect) for effect in best.hypothesis.effects):
        return best
    search.progress(f"fitting {' + '.join(best.hypothesis.ids)} from short windows to long ones")
    found = from_short_windows(search.problem, search.shorter, best.fit.values, best.fit.free)
    return search.keep(best.hypothesis, found)


def _sticks(effect: Effect) -> bool:
    return effect.kind == STICKING


def _at_nominal(values: Mapping[str, float], free: tuple[Free, ...]) -> dict[str, float]:
    return {**values, **{one.name: one.reference for one in free if base_name(one.name) in values}}
