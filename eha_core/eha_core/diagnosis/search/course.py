"""The course of the search: short windows with friction held, friction free, long windows, then what can be dropped."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eha_core.diagnosis.calibrate import Calibration, at_step, filtered_channels, is_at_noise, step_needed
from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.criteria import ALONE, CARRIED, FURTHER, OF_FRICTION, OF_STATES, RELEASED, UNFITTED
from eha_core.diagnosis.hypothesis import NOTHING, Hypothesis, Member, neutral
from eha_core.diagnosis.search.best_sets import objective_without, one_more
from eha_core.diagnosis.search.columns import Column, columns_of, law_columns
from eha_core.diagnosis.search.comparison import Entry, ModelComparison, rank, residual_variance
from eha_core.diagnosis.search.equations import Friction, friction_columns, friction_of
from eha_core.diagnosis.search.expansion import Search, cost, expand, leader, required, search_sets
from eha_core.diagnosis.search.finish import converge, finish, refit_nominal, rivals
from eha_core.diagnosis.search.pool import Pool, Progress, Trace, in_noise_of
from eha_core.diagnosis.search.quadratic import QuadraticModel, with_columns
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit, with_noise
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.numbers import Array
from eha_core.identification.observation import Observation
from eha_core.identification.problem import Problem, whole
from eha_core.identification.shooting import Shooting
from eha_core.identification.short_windows import held


@dataclass(frozen=True)
class Material:
    """What a search works on, the same over windows of all lengths."""

    effects: Sequence[Effect]
    columns: Sequence[Column]
    laws: Sequence[Column]
    plant: tuple[FreeParameter, ...]
    trace: Trace
    progress: Progress
    filtered: frozenset[str]


def find_sets(
    observations: Sequence[Observation],
    calibration: Calibration,
    effects: Sequence[Effect],
    scales: Scales,
    progress: Progress = lambda _: None,
) -> tuple[Calibration, ModelComparison]:
    """The comparison of the best set with what comes near it, and the calibration in the noise that was found."""
    shooting, fitted = calibration.shooting, calibration.fitted
    recordings = len(shooting.first_windows)
    columns = [
        column for effect in effects for column in columns_of(effect, scales, shooting.per_recording, recordings)
    ]
    laws = law_columns([effect for effect in shooting.composition.effects if not effect.named], scales)
    material = Material(effects, columns, laws, _plant(fitted), Trace(), progress, filtered_channels(observations))
    progress("locating in the equations")
    friction = friction_of(observations, calibration.nominal.values, effects, scales)
    calibration, pool = _over_growing_windows(observations, calibration, friction, material)
    progress("searching sets over long windows")
    pool = _with_nominal(pool, calibration)
    if at_the_noise(pool):
        converge(pool, leader(pool))
    search_sets(Search(pool, columns, progress))
    calibration, pool = at_step_needed(observations, calibration, pool, material)
    return finished(pool, calibration, material)


def at_step_needed(
    observations: Sequence[Observation], calibration: Calibration, pool: Pool, material: Material
) -> tuple[Calibration, Pool]:
    """The calibration and the best sets over long windows at the step of the simulation which the best set needs."""
    step_size = step_needed(observations, pool.problem.shooting, pool.found[leader(pool)])
    if step_size == calibration.shooting.step_size:
        return calibration, pool
    material.progress(f"the best set at a step of {1e3 * step_size:g} ms")
    calibration = at_step(observations, calibration, step_size)
    return calibration, _with_nominal(carried(pool, calibration.problem, material), calibration)


def _with_nominal(pool: Pool, calibration: Calibration) -> Pool:
    """A pool over long windows that has the calibrated nominal equations, too."""
    pool.keep(NOTHING, in_noise_of(pool.problem, calibration.shooting, calibration.fitted))
    return pool


def _over_growing_windows(
    observations: Sequence[Observation], calibration: Calibration, friction: Friction, material: Material
) -> tuple[Calibration, Pool]:
    """Sets over short windows, and those over long ones: by way of longer ones, where the way is too far."""
    nominal, long = calibration.nominal.values, calibration.problem
    material.progress("searching sets over short windows")
    short, begin = begun(whole(calibration.shorter[0]), nominal, friction, material)
    if at_the_noise(short):  # so short windows show nothing of what is missing, if anything is
        material.progress("searching sets over long windows")
        pool, begin = begun(long, nominal, friction, material)
        pool = searched(pool, begin, friction, material, laws=False)
    else:
        short = searched(short, begin, friction, material, laws=False)
        pool = carried(short, long, material)
        if at_the_noise(short) and not at_the_noise(pool):  # over long windows the error of the step adds up
            calibration, pool = at_step_needed(observations, calibration, pool, material)
    if at_the_noise(pool):
        return calibration, pool
    material.progress("searching sets over longer windows")
    longer, begin = begun(whole(calibration.shorter[1]), nominal, friction, material)
    bridge = longer.fresh()  # what leads to nothing must not stand in the search's way
    if friction.held is None:  # else the nominal equations have that friction in them
        bridge.adopt(longer)
    carry(short, bridge)
    pool = carried(bridge, calibration.problem, material)
    if at_the_noise(pool):
        return calibration, pool
    material.trace.begun_anew = True
    longer = searched(longer, begin, friction, material, laws=True)
    found = carried(longer, calibration.problem, material)
    found.adopt(pool)
    return calibration, found


def at_the_noise(pool: Pool) -> bool:
    """Whether the best set leaves no more than noise."""
    return pool.leaves_noise(leader(pool))


def _plant(fitted: Fit) -> tuple[FreeParameter, ...]:
    """The plant's own free parameters, each once."""
    return tuple(parameter for parameter in fitted.free if "@" not in parameter.name)


def begun(problem: Problem, nominal: Mapping[str, float], friction: Friction, material: Material) -> tuple[Pool, Fit]:
    """The nominal equations over some windows, the friction of the force balance held in them; and where to begin."""
    plant = held(material.plant, nominal)
    pool = Pool(problem, plant, material.trace, filtered=material.filtered)
    values = {**nominal, **friction.held.values} if friction.held else dict(nominal)
    states = fit(pool.problem, values, (), iterations=OF_STATES).states
    given = pool.at_rest(NOTHING, values, states)
    calibrated = pool.try_set("nominal", NOTHING, values, states, FURTHER)
    pool.measure_noise(NOTHING)
    # nominal values that were fitted without what is missing are bent to it, and all that is seen from there with them
    return pool, pool.found[NOTHING] if is_at_noise(calibrated) else given


def searched(pool: Pool, begin: Fit, friction: Friction, material: Material, laws: bool) -> Pool:
    """Sets over the windows of a pool: without friction where the force balance excludes it; where it shows some, that
    alone, then held while what is large beside it is found, then free; and where asked, laws in no catalogue."""
    base = NOTHING
    if friction.held is None:
        columns = [column for column in material.columns if not (friction.excluded and column.effect.kind)]
        _search(_on_the_way(pool, columns, material), begin)
    else:
        base = NOTHING.with_effects([friction.held.effect])
        pool = _around_friction(pool, begin, friction, material)
        begin = pool.at_rest(base, begin.values, begin.states)
    if laws and not at_the_noise(pool):
        _search_laws(pool, base, begin, material)
    return pool


def _around_friction(pool: Pool, begin: Fit, friction: Friction, material: Material) -> Pool:
    """Sets with the friction that was held in a pool: alone, together with what was found while it was held, and its
    other forms where more than noise is left."""
    held, *others = friction.forms
    at, alone = pool.found[NOTHING], pool.fresh()
    # never given up: sets with that friction begin where it ends, at the noise or not
    alone.try_set("friction free", NOTHING.with_effects([held.effect]), at.values, at.states, ALONE, in_a_row=2)
    if at_the_noise(alone):
        return alone
    columns = [column for column in material.columns if not column.effect.kind]
    search = _on_the_way(pool, columns, material, lambda pool: at_the_noise(pool) or is_due_to(friction, pool))
    _search(search, begin)
    free, ahead = pool.fresh(), _ahead(pool)
    free.adopt(alone)
    for hypothesis in ahead:
        at = pool.found[hypothesis]
        free.try_set("friction free", hypothesis.with_effects([held.effect]), at.values, at.states, RELEASED)
    if at_the_noise(free):
        return free
    at = pool.found[ahead[0]]
    for other in others:
        values = {**at.values, **neutral(held.effect), **other.values}
        free.try_set("form of friction", ahead[0].with_effects([other.effect]), values, at.states, RELEASED)
    search_sets(_on_the_way(free, material.columns, material))
    return free


def is_due_to(friction: Friction, pool: Pool) -> bool:
    """Whether much of the best set's excess chi^2 may be that the friction held has other values, or another form: more
    effects would be named for it."""
    if at_the_noise(pool):
        return False
    best = leader(pool)
    at = pool.found[best]
    model = with_columns(pool.about(best, at), best, friction_columns(friction))
    present = [option for option in model.options if option.present]
    left = [model.empty - model.gain((*present, option))[0] for option in model.options if not option.present]
    return bool(left) and min(left) - at.count < (1.0 - OF_FRICTION) * (at.objective - at.count)


def _on_the_way(
    pool: Pool, columns: Sequence[Column], material: Material, content: Callable[[Pool], bool] = at_the_noise
) -> Search:
    """A search that another follows over long windows: the noise is enough, for what is small beside it costs less to
    find there."""
    return Search(pool, columns, material.progress, content)


def _search(search: Search, begin: Fit) -> None:
    """Search among named effects from the nominal equations of `begin` on."""
    expand(search, NOTHING, "first expansion", begin)
    search_sets(search)


def _search_laws(pool: Pool, base: Hypothesis, begin: Fit, material: Material) -> None:
    """Search among named effects and laws in no catalogue, from the nominal equations of `begin` on: what names did
    wrongly must not stand in a law's way."""
    search = Search(pool, [*material.columns, *material.laws], material.progress, content=at_the_noise)
    expand(search, base, "with laws in no catalogue", begin)
    search_sets(search)
    best = leader(pool)
    at = pool.found[best]
    if at.data > UNFITTED * at.count:  # then no curve is the law, and each bends to whatever is there
        pool.found = {hypothesis: result for hypothesis, result in pool if hypothesis.law is None}


def carried(pool: Pool, problem: Problem, material: Material) -> Pool:
    """The best sets over longer windows, in the noise that was found."""
    if pool.found[leader(pool)].data < 2.0 * pool.found[leader(pool)].count:
        noise = [sampling.noise for sampling in pool.problem.shooting.samplings]
        problem = replace(problem, shooting=with_noise(problem.shooting, noise))
    longer = Pool(problem, material.plant, material.trace, filtered=pool.filtered, released=pool.released)
    carry(pool, longer)
    return longer


def carry(pool: Pool, longer: Pool) -> None:
    """Fit the best sets of one pool in that of longer windows, and measure the noise there."""
    for hypothesis in _ahead(pool):
        at = pool.found[hypothesis]
        states = states_over(longer.problem, pool.problem.shooting, at)
        longer.try_set("longer windows", hypothesis, at.values, states, FURTHER)
    longer.measure_noise(leader(longer))


def states_over(problem: Problem, before: Shooting, at: Fit) -> Array:
    """Where windows begin in a model that was fitted over others: as the nearest of those did, and then fitted."""
    began, begin = (shooting.edges[:-1] * shooting.step_size for shooting in (before, problem.shooting))
    nearest = np.argmin(np.abs(began[None, :] - begin[:, None]), axis=1)
    return fit(problem, at.values, (), at.states[nearest], iterations=OF_STATES).states


def _ahead(pool: Pool) -> list[Hypothesis]:
    """The best set, and the next ones that come near it."""
    ahead = sorted(pool.found, key=lambda hypothesis: cost(hypothesis, pool.found[hypothesis]))[:CARRIED]
    best = pool.found[ahead[0]]
    return [h for h in ahead if cost(h, pool.found[h]) < cost(ahead[0], best) + 3.0 * required(best)]


def ended(pool: Pool, material: Material) -> tuple[Hypothesis, dict[Member, float], list[Hypothesis], QuadraticModel]:
    """The best set at its end, what its members gain, all that was compared with it, and the model about it: once more
    wherever the comparison leaves another set in the lead."""
    best, gains = finish(pool, leader(pool), material.progress)
    if pool.released:
        pool.believe(best)
        converge(pool, best)
    leading, compared, model = rivals(pool, best, material.columns, material.progress)
    seen = {best: pool.found[best].objective}
    while seen.get(leading) != pool.found[leading].objective:
        best, gains = finish(pool, leading, material.progress)
        seen[best] = pool.found[best].objective
        leading, compared, model = rivals(pool, best, material.columns, material.progress)
    return best, gains, compared, model


def finished(pool: Pool, calibration: Calibration, material: Material) -> tuple[Calibration, ModelComparison]:
    """The best set fitted to its end, without what is not significant, with its rivals and the nominal model."""
    material.progress("fitting the best set to its end")
    best, gains, compared, model = ended(pool, material)
    found = {hypothesis: pool.found[hypothesis] for hypothesis in compared if hypothesis.members}
    nominal = refit_nominal(pool, pool.found[NOTHING], list(found.values()))
    before, shooting = calibration.shooting, pool.problem.shooting
    given, fitted = (in_noise_of(pool.problem, before, at) for at in (calibration.nominal, calibration.fitted))
    calibration = replace(calibration, shooting=shooting, problem=pool.problem, nominal=given, fitted=fitted)
    comparison = ModelComparison(
        Entry(NOTHING, nominal, 0.0),
        rank(nominal, found),
        residual_variance([nominal, *found.values()]),
        _gains_by_site(model, best, nominal),
        _left_over(model, best),
        {h: result for h, result in pool if h in {best.without(member) for member in best.members}},
        gains,
        tuple(material.trace.steps),
        material.trace.begun_anew,
    )
    return calibration, comparison


def _gains_by_site(model: QuadraticModel, best: Hypothesis, nominal: Fit) -> dict[str, float]:
    """What the members of each site explain together with the others, those of the only one over the nominal equations
    as they were fitted; of no set, what a single effect would."""
    if not best.members:
        return _left_over(model, best)
    sites = {member.effect.site for member in best.members}
    if len(sites) == 1:
        return dict.fromkeys(sites, nominal.objective - model.at.objective)
    return {
        site: objective_without(model, [member for member in best.members if member.effect.site == site])
        - model.at.objective
        for site in sites
    }


def _left_over(model: QuadraticModel, best: Hypothesis) -> dict[str, float]:
    """What one more effect together with the best is predicted to gain, the most of each site."""
    gains: dict[str, float] = {}
    for proposal in one_more(model):
        added = next(option.member for option in proposal.options if not option.present)
        gain = model.at.objective - proposal.predicted
        gains[added.effect.site] = max(gain, gains.get(added.effect.site, 0.0))
    return gains
