"""Recordings in which nothing is wrong, of rigs and tests of every kind: none of them may be refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from eha_core.parameters import nominal_values
from eha_core.recording import Recording
from eha_exam.case import Case
from eha_exam.concealed import draw_effect
from eha_exam.drawing import LOAD, draw_case
from eha_exam.measuring import measure, simulate_case
from eha_exam.second import with_other_loads
from eha_exam.tiers import plan
from tools.hostile.plant_tests import is_of_the_catalogue, run_on_plant
from tools.hostile.wrong_recordings import SUBSETS, Arrays, as_recording, with_velocity

SHORTEST = 2.0
"""s; a shorter recording of these rigs' motions holds too little to judge."""


BY_TRUTH = 10
"""One in so many recordings is made by the exam's truth whatever is concealed."""
LONGEST = 8.0
"""s of a test are made, and all of it where an effect begins or ends during it."""


@dataclass(frozen=True)
class Sound:
    """A sound recording: of which case, what is special about it, and the nominal values that go with it."""

    case: str
    kind: str
    recording: Recording
    nominal: Mapping[str, float]


def sound_recordings(seed: int, count: int) -> Iterator[Sound]:
    """Recordings of the exam's rigs, every tier and every kind in turn.

    One in ten, and those of effects that the catalogue does not have or that act over an interval, by the exam's
    independent truth; the others by the simulated plant.
    """
    for index, (tier, number) in enumerate(plan(count)):
        kind = list(KINDS)[index % len(KINDS)]
        case = draw_case(tier, number, seed)
        chance = np.random.default_rng([case.seed, 12])
        case = KINDS[kind](_shortened(case), chance)
        measured: Arrays
        if case.loads and index % 2:
            kind, measured = f"{kind}, second load", with_other_loads(case)[0]
        else:
            by_plant = index % BY_TRUTH and is_of_the_catalogue(case)
            truth = run_on_plant(case) if by_plant else simulate_case(case)
            measured = with_velocity(case, measure(case, truth), truth)
        if kind == "reversed polarity" and case.family != "single_rod":
            measured = mirrored(measured)
        lacking = SUBSETS[int(chance.integers(len(SUBSETS)))]
        arrays = {name: pair for name, pair in measured.items() if name not in lacking}
        yield Sound(case.name, kind, as_recording(arrays), {**nominal_values(), **case.nominal})


def mirrored(arrays: Arrays) -> Arrays:
    """What the same test records where the positive directions of valve, sensors and chambers are all the other."""
    other = {"pressure_a": "pressure_b", "pressure_b": "pressure_a"}
    return {
        name: (arrays[other[name]] if name in other else (time, -values)) for name, (time, values) in arrays.items()
    }


def _shortened(case: Case) -> Case:
    whole = case.windows or "leakage_onset" in case.effect_ids
    return case if whole else replace(case, duration=min(case.duration, LONGEST))


def _as_drawn(case: Case, _: np.random.Generator) -> Case:
    return case


def _closed_loop(case: Case, chance: np.random.Generator) -> Case:
    return replace(case, loop=float(chance.uniform(6.0, 15.0)))


def _loaded(case: Case, chance: np.random.Generator) -> Case:
    """With a load, a weight that hangs or a spring that pushes, beside what is concealed."""
    others = tuple(effect for effect in case.effects if effect[0] != LOAD)
    return replace(case, effects=(*others, (LOAD, draw_effect(LOAD, case.setting, chance))))


def _short(case: Case, chance: np.random.Generator) -> Case:
    return replace(case, duration=float(np.round(chance.uniform(SHORTEST, 5.0), 1)))


def _small(case: Case, chance: np.random.Generator) -> Case:
    """A test of some per cent of the usual travel: a millimetre or so."""
    share = float(chance.uniform(0.02, 0.1))
    return replace(case, amplitude=share * case.amplitude, speed=share * case.speed)


def _coarse(case: Case, chance: np.random.Generator) -> Case:
    """Sensors of a cheap logger: 25 um to 0.1 mm, 0.05 to 0.2 MPa, 100 or 200 samples a second."""
    position_step, pressure_step = float(chance.uniform(25e-6, 1e-4)), float(chance.uniform(5e4, 2e5))
    rate = float(chance.choice((100.0, 200.0)))
    return replace(case, position_step=position_step, pressure_step=pressure_step, rate=rate)


KINDS: Mapping[str, Callable[[Case, np.random.Generator], Case]] = {
    "as drawn": _as_drawn, "closed loop": _closed_loop, "loaded": _loaded, "reversed polarity": _as_drawn,
    "short": _short, "small": _small, "coarse": _coarse,
}  # fmt: skip
"""What is changed of a case of the exam."""
