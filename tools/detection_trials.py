"""How often effects are found, beside what `eha detect` predicts: on drawn rigs, tests, effects and sizes.

    python -m tools.detection_trials --rigs 1000 --seed S --out FILE [--first K] [--jobs 2]

Each rig and its test are drawn as the exam draws them. One effect is drawn, in one of the shapes that the search tries,
and the probability with which it is to be found: its size follows from the linearisation and, as in a certificate, is
enlarged where fitted nominal equations explain more. What they leave is the prediction. Then noise is drawn, the
equations are fitted with and without the effect, and the gain is compared with that required. Fits begin near the
truth: what the search does not find is not seen here. A line of FILE is one rig, and rigs that are there already are
not drawn again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np

from eha_core.detectability import PlannedTest
from eha_core.detectability.planned import linearised
from eha_core.detectability.refit import confirmed, left_by_nominal
from eha_core.diagnosis.criteria import TO_THE_END
from eha_core.diagnosis.detection.power import energy_needed, probability_of
from eha_core.diagnosis.detection.responses import FittedModel
from eha_core.diagnosis.detection.sizes import Trial, smallest, trials
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.hypothesis import neutral
from eha_core.identification.fit import exact, fit
from eha_core.identification.numbers import Array
from eha_core.identification.problem import Problem
from eha_core.nominal import nominal_of
from eha_exam.drawing import draw_case
from eha_exam.excitation import draw_reference, feedforward
from eha_exam.plants import Rig
from tools.trial_rows import try_rigs

PROBABILITIES = (0.02, 0.98)
"""Between which the probability is drawn with which the linearisation predicts that an effect is found."""
DECILES = 10


def try_rig(number: int, seed: int) -> dict[str, Any]:
    """One rig: the effect, the probability predicted and whether it was found; `why` where nothing can be compared."""
    generator = np.random.default_rng([seed, number])
    nominal, test = _rig_and_test(number, seed)
    at = linearised(nominal_of(nominal), test)
    tried = trials(at)
    names = sorted({trial.column.effect.id for trial in tried})
    name = str(generator.choice(names))
    of_it = [trial for trial in tried if trial.column.effect.id == name]
    trial = of_it[int(generator.integers(len(of_it)))]
    wanted = float(generator.uniform(*PROBABILITIES))
    row: dict[str, Any] = {"number": number, "effect": name, "wanted": wanted}
    energy = at.variance * energy_needed(trial.gain / at.variance, trial.parameters, wanted)
    factor = float(smallest(at, [replace(trial, energy=energy)])[0])
    if not (isfinite(factor) and factor > 0.0):
        return row | {"why": "not found at any size"}
    (larger,) = confirmed(at, [replace(trial, energy=energy)], [factor])
    if not isfinite(larger):
        return row | {"why": "not found at any size"}
    left = left_by_nominal(at, trial.at(larger), thorough=True)
    left, factor = (left if larger > factor else min(left, energy)), larger
    found = is_found(at, at.with_effect(trial.at(factor)), trial, generator)
    return row | {"predicted": probability_of(left, trial.gain, trial.parameters), "found": found}


def _rig_and_test(number: int, seed: int) -> tuple[dict[str, float], PlannedTest]:
    """A rig and its test as the exam draws them, the command by the unloaded rig's inverse."""
    case = draw_case("null", number, seed)
    rig = Rig(case.family, case.plant)
    time = np.arange(round(case.duration * case.rate) + 1) / case.rate
    reference = draw_reference(case.shape, rig, time, case.amplitude, case.speed, np.random.default_rng([case.seed, 1]))
    voltages = feedforward(rig, reference, case.rate)
    return dict(case.nominal), PlannedTest(time, voltages, case.duration, noise=case.noise, rate=case.rate)


def is_found(at: FittedModel, rig: FittedModel, trial: Trial, generator: np.random.Generator) -> bool:
    """Whether the effect gains what is required of it in a rig's record with drawn noise. Either model is fitted from
    where the other ended, too."""
    effect, shooting = trial.column.effect, rig.pool.problem.shooting
    noisy = [one.values + one.noise * generator.standard_normal(len(one.values)) for one in shooting.samplings]
    problem = exact(measuring(rig.pool.problem, noisy))
    off = neutral(effect)
    free = with_effects(at.pool.plant, [effect], rig.fit.values)
    present = fit(problem, rig.fit.values, free, rig.fit.states, iterations=TO_THE_END, in_a_row=2)
    absent = min(
        (
            fit(problem, {**begin.values, **off}, at.pool.plant, begin.states, iterations=TO_THE_END, in_a_row=2)
            for begin in (rig.fit, present)
        ),
        key=lambda result: result.objective,
    )
    return bool(absent.objective - present.objective > trial.gain)


def measuring(problem: Problem, measured: Sequence[Array]) -> Problem:
    """The problem with other samples measured."""
    pairs = zip(problem.shooting.samplings, measured, strict=True)
    samplings = tuple(replace(sampling, values=values) for sampling, values in pairs)
    return replace(problem, shooting=replace(problem.shooting, samplings=samplings))


def by_decile(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """The table of predicted and observed shares, in bins of the predicted probability with as many rigs in each."""
    compared = sorted((row for row in rows if "found" in row), key=lambda row: float(row["predicted"]))
    yield f"| predicted | rigs | predicted, mean | found | standard error |\n{'|---' * 5}|"
    for some in np.array_split(np.arange(len(compared)), DECILES):
        if not len(some):
            continue
        predicted = np.array([compared[k]["predicted"] for k in some])
        found = np.array([compared[k]["found"] for k in some])
        error = float(np.sqrt(np.sum(predicted * (1.0 - predicted)))) / len(some)
        yield (
            f"| {predicted[0]:.2f} to {predicted[-1]:.2f} | {len(some)} | {predicted.mean():.3f} | {found.mean():.3f} |"
            f" {error:.3f} |"
        )
    yield f"\n{len(compared)} rigs compared, {len(rows) - len(compared)} with an effect not found at any size"


if __name__ == "__main__":
    try_rigs(try_rig, by_decile, __doc__, 1000)
