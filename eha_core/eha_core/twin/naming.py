"""Which single effect, or parameter of the model, explains a departure best, from the seconds since it began.

Everything that could explain it is put into one quadratic model about the twin's own values; what that predicts to do
best is fitted, so that sizes, intervals and rivals rest on the equations themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from eha_core.diagnosis.calibrate import STEPS
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.criteria import PARTLY, TIE, chance_gain, parameter_cost
from eha_core.diagnosis.detection.power import required_gain
from eha_core.diagnosis.detection.responses import FittedModel
from eha_core.diagnosis.detection.rows import leak_flows
from eha_core.diagnosis.effect_parameters import free_effect_parameters
from eha_core.diagnosis.hypothesis import NOTHING, Hypothesis, neutral
from eha_core.diagnosis.search.best_sets import one_more
from eha_core.diagnosis.search.box import within_bounds
from eha_core.diagnosis.search.columns import applicable_effects, columns_of
from eha_core.diagnosis.search.pool import Pool, Trace
from eha_core.diagnosis.search.quadratic import QuadraticModel, quadratic_model
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.free_parameters import FreeParameter, free_nominal_parameters, not_believed, values_at
from eha_core.identification.numbers import Array
from eha_core.identification.observation import FITTED, Measured, Observation
from eha_core.identification.problem import whole
from eha_core.identification.segments import cut
from eha_core.identification.shooting import SETTLING
from eha_core.identification.short_windows import SHORT, with_finer_slopes
from eha_core.parameters import catalogue
from eha_core.plant import Plant
from eha_core.realtime import NANOSECONDS
from eha_core.recording.simulated import POSITION_NOISE, PRESSURE_NOISE, Experiment, simulate
from eha_core.twin.comparison import Settings
from eha_core.twin.excerpt import Excerpt, Stamps
from eha_core.twin.explanation import Cause, Departure, Explanation, Size
from eha_core.weak_form.model_errors import CHANNELS

FINALISTS = 8
"""Causes that are fitted, those that are predicted to explain most: what an effect does is seldom in proportion to its
size, so the best in the quadratic model need not be the best (assumed)."""

ITERATIONS = 12
"""Of such a fit at most; most end after six."""

MAY_LEAVE = 0.001
"""Share of the chi^2 beyond noise that a cause may leave where that is more: the model of a rig that is far off is
hardly better than to 3 % (assumed)."""

CHANCE_DEVIATIONS = 2.0
"""Standard deviations of chi^2 by which noise alone may seem to leave something."""

KNOWN_INSTANT = "schedule"
"""The site of effects that begin at an instant, or drift: when a departure began is known, and seconds show no
drift."""


@dataclass(frozen=True)
class _Guess:
    """A cause with what a fit of it moves, and where that begins; `predicted`: the objective at its best."""

    name: str
    sizes: tuple[str, ...]
    hypothesis: Hypothesis
    free: tuple[FreeParameter, ...]
    values: Mapping[str, float]
    predicted: float


def explain(departure: Departure) -> Explanation:
    """Name the single cause of a departure and what cannot be distinguished from it.

    Every other value is held at the twin's. Nothing is named that gains no more than chance explains, or that leaves
    much of the departure.
    """
    with threadpool_limits(1):
        at = _as_modelled(departure)
        count, before = at.fit.count, at.fit
        seconds = at.observations[0].duration - SETTLING
        guesses = sorted(_guesses(at), key=lambda guess: guess.predicted)[:FINALISTS]
        fits = [(guess, _fitted(at, guess)) for guess in guesses]
        if not fits:
            return Explanation(seconds, None)
        least = max(1.0, min(found.data for _, found in fits) / count)
        cost = parameter_cost(count, least)
        ranked = sorted(
            ((found.objective + cost * len(guess.free), guess, found) for guess, found in fits), key=lambda row: row[0]
        )
        score, best, found = ranked[0]
        needed = required_gain(chance_gain(count, least), len(best.free), count, least)
        if before.objective - found.objective < needed or found.data - count > _may_leave(before):
            return Explanation(seconds, None)
        rivals = (_cause(at, guess, result) for other, guess, result in ranked[1:] if other - score < TIE * least)
        return Explanation(seconds, _cause(at, best, found), tuple(rivals), (found.data / count) ** 0.5)


def _may_leave(before: Fit) -> float:
    """Chi^2 beyond noise that a cause may leave of what the twin's model leaves: PARTLY, while a twin tolerates that by
    default."""
    count, excess = before.count, max(before.data - before.count, 0.0)
    tolerable = min((Settings.threshold**2 - 1.0) * count, PARTLY * excess)
    return float(max(tolerable, MAY_LEAVE * excess) + CHANCE_DEVIATIONS * np.sqrt(2.0 * count))


def _as_modelled(departure: Departure) -> FittedModel:
    """The seconds with the twin's model, of which only the windows' starts are fitted."""
    observation = _observed(departure)
    values, step = dict(departure.parameters), STEPS[0]
    problem = whole(cut(observation, values, step))
    travel = float(np.max(np.abs(observation.measured[0].values)))
    rows = observation.composition.place_rows
    plant = free_nominal_parameters(values, observation.drive, travel)
    pool = Pool(problem, tuple(not_believed(one, rows[one.name]) for one in plant), Trace())
    at = fit(problem, values, (), iterations=ITERATIONS)
    scales = characteristic_scales([observation], problem.shooting, at)
    return FittedModel((observation,), pool, NOTHING, at, scales)


def _observed(departure: Departure) -> Observation:
    """The excerpt as what a fit explains, with the noise that the twin found."""
    excerpt = departure.excerpt

    def seconds(stamps: Stamps) -> Array:
        return np.asarray((stamps - excerpt.start) / NANOSECONDS, dtype=np.float64)

    measured = tuple(
        Measured(name, FITTED.index(name), seconds(excerpt.channels[name][0]), excerpt.channels[name][1], noise)
        for name, noise in departure.noises.items()
    )
    stamps, voltages = excerpt.voltage
    duration = (excerpt.end - excerpt.start) / NANOSECONDS
    driving = "voltage_command"
    return Observation(
        "twin", "voltage", ((seconds(stamps), voltages),), measured, (), duration, (driving, *departure.noises), (), ()
    )


def _guesses(at: FittedModel) -> Iterator[_Guess]:
    """Everything that could be the cause, each effect in the shape that is predicted to explain most."""
    values, effects = at.fit.values, applicable_effects(at.observations)
    present = NOTHING.with_effects(effect for effect in effects if _acts(effect, values))
    absent = [effect for effect in effects if present.admits(effect) and effect.site != KNOWN_INSTANT]
    columns = [column for effect in absent for column in columns_of(effect, at.scales)]
    modelled = (*at.pool.plant, *(one for effect in present.effects for one in free_effect_parameters(effect, values)))
    model = quadratic_model(at.pool.problem, at.fit, NOTHING, modelled, columns)
    for place, parameter in enumerate(modelled):
        gain, move = _alone(model, place)
        moved = values_at(values, [parameter], model.at.q[[place]] + move)
        yield _Guess(parameter.name, (parameter.name,), present, (parameter,), moved, model.empty - gain)
    alone = replace(model, nominal=0)  # nothing but the effect moves
    named = set()
    for proposal in sorted(one_more(alone), key=lambda proposal: proposal.predicted):
        (option,) = proposal.options
        if option.member.id in named:
            continue
        named.add(option.member.id)
        moved, _ = alone.start(proposal.options)
        sizes = tuple(dict.fromkeys(name for column in option.columns for name in column.sizes))
        free = free_effect_parameters(option.member.effect, moved)
        hypothesis = present.with_effects([option.member.effect])
        yield _Guess(option.member.id, sizes, hypothesis, free, moved, proposal.predicted)


def _acts(effect: Effect, values: Mapping[str, float]) -> bool:
    """Whether the model has the effect in it."""
    return any(values[name] != nothing for name, nothing in neutral(effect).items())


def _alone(model: QuadraticModel, place: int) -> tuple[float, Array]:
    """What one of the parameters gains by itself, and its move."""
    found = np.empty(1)
    places = np.array([place], dtype=np.int64)
    gain = within_bounds(model.matrix, model.gradient, model.lower, model.upper, places, 1, found)
    return gain, found / model.scale[places]


def _fitted(at: FittedModel, guess: _Guess) -> Fit:
    """A guess at its best, the windows begun as measured, for the twin's own model bends their starts. Where friction
    may stick it is begun over short windows, too, in which no break-away comes late."""
    problem = at.pool.posed(guess.hypothesis)
    found = fit(problem, guess.values, guess.free, iterations=ITERATIONS)
    if not guess.hypothesis.kinds:
        return found
    values = guess.values
    for length in SHORT:
        shorter = cut(at.observations[0], values, problem.shooting.step_size, length)
        values = fit(with_finer_slopes(whole(shorter)), values, guess.free, iterations=ITERATIONS).values
    other = fit(problem, values, guess.free, iterations=ITERATIONS)
    return min(found, other, key=lambda fitted: fitted.objective)


def _cause(at: FittedModel, guess: _Guess, found: Fit) -> Cause:
    """A fitted cause; where it leaves more than noise, that widens its intervals."""
    wider = max(1.0, found.data / found.count) ** 0.5
    rows, modelled = catalogue(), at.fit.values
    sizes = tuple(
        Size(name, found.values[name], wider * found.deviation(name), modelled[name], rows[name].unit)
        for name in guess.sizes
    )
    (flow,) = leak_flows(replace(at, fit=found), [{size.name: size.modelled for size in sizes}], SETTLING)
    if flow is None:
        return Cause(guess.name, sizes)
    surest = max(sizes, key=lambda size: abs(size.change) / size.deviation)
    return Cause(guess.name, sizes, (flow, abs(flow * surest.deviation / surest.change)))


def prepare() -> None:
    """Compile all that `explain` needs, on a second of a rig with a leak."""
    times = np.asarray(np.arange(500) * 0.002, dtype=np.float64)
    voltages: Array = np.asarray(0.1 * np.sin(12.0 * times), dtype=np.float64)
    record = simulate(Experiment(times, voltages, 1.0, {"internal_leakage": 1e-10}, noise=1.0))
    channels = {name: (record.stamps, record.column(f"measured_{name}")) for name in CHANNELS}
    excerpt = Excerpt(int(record.stamps[0]), int(record.stamps[-1]), record.commands, channels)
    noises = dict(zip(CHANNELS, (POSITION_NOISE, PRESSURE_NOISE, PRESSURE_NOISE), strict=True))
    explain(Departure(excerpt, Plant().parameters, noises))
