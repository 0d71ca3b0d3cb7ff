"""Fits that go on from other instants: derivatives lead no farther than what a sample or two see."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from eha_core.diagnosis.criteria import CONVERGED, FINER_REACH, REACH, TO_THE_STEP
from eha_core.diagnosis.hypothesis import Hypothesis, Member
from eha_core.diagnosis.search.columns import Column
from eha_core.diagnosis.search.derivatives import Derivatives
from eha_core.diagnosis.search.pool import Pool
from eha_core.diagnosis.search.quadratic import QuadraticModel, with_columns
from eha_core.identification.fit import HOPE
from eha_core.identification.per_recording import base_name
from eha_core.plant.lane_rows import LANES


def shift_instants(pool: Pool, hypothesis: Hypothesis, give_up_above: float = np.inf) -> None:
    """Fit a set on from other instants where one of those leaves less once all else has adapted to it, unless HOPE
    times what is predicted of that would not bring the objective below `give_up_above`."""
    at, about = pool.found[hypothesis], None
    instants = [parameter.name for parameter in at.free if parameter.resolution]
    for reach, name in product([REACH * FINER_REACH**k for k in range(TO_THE_STEP)], instants):
        if about is None or at is not pool.found[hypothesis]:
            at = pool.found[hypothesis]
            about = pool.about(hypothesis, at)
        member = next(one for one in hypothesis.members if base_name(name) in _names_of(one))
        model = _elsewhere(about, hypothesis, member, name, reach)
        present = [option for option in model.options if option.present]
        places = [(*present, option) for option in model.options if not option.present]
        left = [model.empty - model.gain(place)[0] for place in places]
        gain = at.objective - min(left, default=np.inf)
        if gain > 0.0 and at.objective - HOPE * gain < give_up_above:
            values, states = model.start(places[int(np.argmin(left))])
            pool.try_set("other instants", hypothesis, values, states, CONVERGED, give_up_above=at.objective)


def _names_of(member: Member) -> tuple[str, ...]:
    return (*member.effect.parameter_names(), *member.effect.acting_names())


def _elsewhere(about: Derivatives, hypothesis: Hypothesis, member: Member, name: str, reach: float) -> QuadraticModel:
    """The model about a fit with one instant at other places besides, each a column that is there as it is."""
    shifts = [float(shift) for shift in reach * np.linspace(-1.0, 1.0, LANES - 1) if shift]
    columns = [
        Column(member.effect, {name: max(about.at.values[name] + shift, 0.0)}, (), number, True, 1.0)
        for number, shift in enumerate(shifts)
    ]
    model = with_columns(about, hypothesis, columns)
    first = len(model.lower) - len(columns)
    return replace(model, lower=np.concatenate([model.lower[:first], model.upper[first:]]))
