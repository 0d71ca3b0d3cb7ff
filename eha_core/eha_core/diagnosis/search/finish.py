"""The end of the search: the best set fitted to its end, what is not significant dropped, and its rivals fitted too."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from statistics import fmean

import numpy as np

from eha_core.diagnosis.calibrate import is_at_noise
from eha_core.diagnosis.criteria import (
    AT_FIRST,
    CHANCE,
    CLEARLY,
    COMPARED_WITHIN,
    CONTENDING,
    CONVERGED,
    CONVINCING,
    FAR_FROM_NOISE,
    FITTED,
    FURTHER,
    NOISE_KNOWN,
    OF_ITS_FORM,
    OF_SAMPLES,
    OF_SAMPLES_BESIDE_A_FORM,
    UNLIKELY,
    chance_gain,
)
from eha_core.diagnosis.hypothesis import NOTHING, Hypothesis, Member, neutral
from eha_core.diagnosis.search.best_sets import Proposal, best_sets, objective_without, one_more
from eha_core.diagnosis.search.columns import Column
from eha_core.diagnosis.search.comparison import Entry, rank
from eha_core.diagnosis.search.instants import shift_instants
from eha_core.diagnosis.search.intervals import in_span
from eha_core.diagnosis.search.pool import Pool, Progress
from eha_core.diagnosis.search.quadratic import QuadraticModel, quadratic_model, with_columns
from eha_core.identification.fit import Ending, Fit, exact, fit
from eha_core.identification.numbers import Array
from eha_core.identification.per_recording import base_name


def converge(pool: Pool, hypothesis: Hypothesis, give_up_above: float = np.inf) -> Fit:
    """Fit a set until nothing is gained, with derivatives at the full step, unless it was or cannot come low enough."""
    at = pool.found[hypothesis]
    if pool.settled.get(hypothesis) != at.objective:
        result = fit(
            exact(pool.problem), at.values, at.free, at.states,
            iterations=CONVERGED, in_a_row=2, give_up_above=give_up_above,
        )  # fmt: skip
        pool.trace.add("converge", hypothesis, result)
        at = pool.keep(hypothesis, result)
        pool.settled[hypothesis] = at.objective
    return at


def finish(pool: Pool, hypothesis: Hypothesis, progress: Progress) -> tuple[Hypothesis, dict[Member, float]]:
    """The set fitted to its end, without the members whose removal raises chi^2 by no more than is required of them;
    and what each that stays gains over what is required."""
    converge(pool, hypothesis)
    from_nominal_values(pool, hypothesis)
    shift_instants(pool, hypothesis)
    at, gains = pool.found[hypothesis], dict[Member, float]()
    while len(gains) < len(hypothesis.members):
        if not gains:
            costs = predicted_costs(pool, hypothesis, at)
            needed = {
                member: np.inf if is_of_a_filters_form(pool, member, at) else required_of(pool, member, costs, at)
                for member in costs
            }
        # a law in no catalogue first: what names explain must not be left to its curve
        rest = costs.keys() - gains.keys()
        member = min(rest, key=lambda member: (not member.variable, costs[member] / needed[member], member))
        if not member.variable and costs[member] > CLEARLY * needed[member]:
            gains[member] = costs[member] / needed[member]
            continue
        simpler = _without(pool, hypothesis, member, at, needed[member])
        lost = simpler.objective - at.objective
        progress(f"without {member.id}: chi^2 rises by {lost:.4g}, {needed[member]:.4g} is required")
        if lost > needed[member]:
            gains[member] = lost / needed[member]
        else:
            pool.excessive.add(hypothesis)
            # far from the noise no optimum is worth its last digits
            hypothesis, gains = hypothesis.without(member), {}
            near = hypothesis.members and simpler.data < FAR_FROM_NOISE * simpler.count
            at = converge(pool, hypothesis) if near else simpler
    return hypothesis, gains


def from_nominal_values(pool: Pool, hypothesis: Hypothesis) -> None:
    """Fit a set that was fitted to its end once more from the plant's nominal values, where one has gone unlikely far:
    it may rest in a minimum to which another set led."""
    at = pool.found[hypothesis]
    names = {one.name for one in pool.plant}
    plant = [one for one in at.free if base_name(one.name) in names]
    if not any(abs(one.coordinate(at.values[one.name])) > UNLIKELY * one.prior_deviation for one in plant):
        return
    values = {**at.values, **{one.name: one.reference for one in plant}}
    states = fit(pool.problem, values, (), at.states, iterations=FURTHER).states
    pool.try_set("from nominal values", hypothesis, values, states, CONVERGED, at.free, 2)
    converge(pool, hypothesis)


def predicted_costs(pool: Pool, hypothesis: Hypothesis, at: Fit) -> dict[Member, float]:
    """What the curvature says that chi^2 rises by without each member."""
    model = quadratic_model(exact(pool.problem), at, hypothesis, pool.plant, ())
    return {
        option.member: max(objective_without(model, [option.member]) - at.objective, 0.0) for option in model.options
    }


def _without(pool: Pool, hypothesis: Hypothesis, member: Member, at: Fit, needed: float) -> Fit:
    """The set without a member, fitted from where the whole set stands until it comes near enough or does not."""
    rest = hypothesis.without(member)
    off = neutral(member.effect)
    values = {name: off.get(base_name(name), value) for name, value in at.values.items()}
    free = tuple(parameter for parameter in at.free if base_name(parameter.name) not in off)
    pool.try_set("without a member", rest, values, at.states, CONVERGED, free, 2, at.objective + needed)
    if pool.found[rest].objective - at.objective > needed:
        # what acts together with the member may begin elsewhere without it
        shift_instants(pool, rest, at.objective + needed)
    return pool.found[rest]


def required_of(pool: Pool, member: Member, costs: Mapping[Member, float], at: Fit) -> float:
    """Chi^2 that a member has to explain together with the others.

    More than chance, more than what the form of the other laws leaves in its equation, and most of what the set would
    leave without it.
    """
    variance, count = max(1.0, at.data / at.count), at.count
    left = max(at.data - count, 0.0)
    ratio = CONVINCING / (1.0 - CONVINCING)
    forms = [other for other in costs if other != member and other.effect.approximate]
    by_chance = member.size * variance * (CHANCE + OF_SAMPLES * count)
    if costs[member] < by_chance and forms:
        # friction makes the objective rugged, and a refit may stop short: the curvature is believed
        by_chance = member.size * variance * (CHANCE + OF_SAMPLES_BESIDE_A_FORM * count)
    of_forms = min(left_by_forms(pool, member, costs, at), ratio * (left + NOISE_KNOWN * count))
    return max(by_chance + of_forms, ratio * max(left - NOISE_KNOWN * count, 0.0))


def is_of_a_filters_form(pool: Pool, member: Member, at: Fit) -> bool:
    """Whether a member only delays signals, by less than a sampling period of a channel behind a filter: by so much
    filters of one cutoff delay differently, and beside one that is faster than its lag all other signals seem late."""
    if not member.effect.only_delays:
        return False
    shooting, names = pool.problem.shooting, member.effect.parameter_names()
    delays = [value for name, value in at.values.items() if base_name(name) in names]
    pairs = zip(shooting.names, shooting.samplings, strict=True)
    periods = [float(np.median(np.diff(shooting.times(one)))) for name, one in pairs if name in pool.filtered]
    return max(delays) < max(periods, default=0.0)


def left_by_forms(pool: Pool, member: Member, costs: Mapping[Member, float], at: Fit) -> float:
    """Chi^2 that the form of other laws may leave in a member's equation: a share of what they explain."""
    nothing = pool.found.get(NOTHING)
    explained = max(nothing.objective - at.objective, 0.0) if nothing else np.inf
    forms = (other for other in costs if other != member and other.effect.approximate and meet(member, other))
    return OF_ITS_FORM * min(sum(costs[other] for other in forms), explained)


def meet(member: Member, other: Member) -> bool:
    """Whether two effects act in one equation, of the piston's forces or of the oil's flow; a sensor shows both."""
    sites = (member.effect.site, other.effect.site)
    return any(site in ("sensor", "schedule") for site in sites) or (sites[0] == "force") == (sites[1] == "force")


def rivals(
    pool: Pool, best: Hypothesis, columns: Sequence[Column], progress: Progress
) -> tuple[Hypothesis, list[Hypothesis], QuadraticModel]:
    """The best set, once what comes near it was fitted to its end too; all of those; and the model about the best."""
    at = pool.found[best]
    columns = [column for column in columns if not (is_at_noise(at) and column.variable)]
    model = _about(pool, best, columns)
    within = COMPARED_WITHIN * max(1.0, at.data / at.count)
    near: dict[Hypothesis, Proposal] = {}
    for size, level in best_sets(model, best.size + 1).items():
        for proposal in level if abs(size - best.size) <= 1 else ():
            hypothesis = _set_of(proposal)
            adds_only = set(best.members) <= set(hypothesis.members)
            if hypothesis != best and not adds_only and proposal.predicted < at.objective + within:
                near.setdefault(hypothesis, proposal)
    for hypothesis, proposal in sorted(near.items(), key=lambda item: item[1].predicted)[:FITTED]:
        values, states = model.start(proposal.options)
        _compare(pool, "rival", hypothesis, values, states, at.objective + within, progress)
    for hypothesis, values in in_a_members_place(pool, best, columns, at.objective + within):
        if hypothesis not in pool.found and has_simpler_form(hypothesis, best):
            pool.try_set("in its place", hypothesis, values, at.states, FURTHER)  # what it lacks may be one more effect
        else:
            _compare(pool, "in its place", hypothesis, values, at.states, at.objective + within, progress)
    for base in of_simpler_form(pool, best):
        beside = _about(pool, base, columns)
        more: dict[Hypothesis, Proposal] = {}
        for proposal in sorted(one_more(beside), key=lambda proposal: proposal.predicted)[:FITTED]:
            if proposal.predicted < at.objective + within:
                more.setdefault(_set_of(proposal), proposal)
        for hypothesis, proposal in more.items():
            values, states = beside.start(proposal.options)
            _compare(pool, "simpler form", hypothesis, values, states, at.objective + within, progress)
    for hypothesis in _near_the_noise(pool, best):
        progress(f"comparing with {' + '.join(hypothesis.ids)}")
        pool.go_on("rival", hypothesis, FURTHER, give_up_above=at.objective + within)
    close = [
        hypothesis for hypothesis, result in pool
        if hypothesis != best and result.objective < at.objective + within and hypothesis.members
        and hypothesis not in pool.excessive and not set(best.members) < set(hypothesis.members)
    ]  # fmt: skip
    for hypothesis in sorted(close, key=lambda h: pool.found[h].objective)[:FITTED]:
        converge(pool, hypothesis, at.objective + within)
    compared = [best, *close]
    ranked = _ranked(pool, compared)
    for entry in ranked:
        if entry.hypothesis != best and entry.score > ranked[0].score - CONTENDING:
            shift_instants(pool, entry.hypothesis)  # as the best set was
    return _ranked(pool, compared)[0].hypothesis, compared, model


def _near_the_noise(pool: Pool, best: Hypothesis) -> list[Hypothesis]:
    """Sets that a few iterations brought to the noise, and that were left there because another came lower by then: how
    far down they lead, nobody has seen."""
    found = [
        (result.objective, hypothesis) for hypothesis, result in pool
        if hypothesis.members and is_at_noise(result) and result.ending is Ending.ITERATIONS
        and not set(best.members) <= set(hypothesis.members)
    ]  # fmt: skip
    return [hypothesis for _, hypothesis in sorted(found)[:FITTED]]


def _ranked(pool: Pool, compared: Sequence[Hypothesis]) -> tuple[Entry, ...]:
    return rank(pool.found[NOTHING], {hypothesis: pool.found[hypothesis] for hypothesis in compared})


def _about(pool: Pool, hypothesis: Hypothesis, columns: Sequence[Column]) -> QuadraticModel:
    """The quadratic model about a set, with all that can be added to it."""
    addable = [c for c in columns if c.effect.id not in hypothesis.ids and c.effect.kind not in hypothesis.kinds]
    return with_columns(pool.about(hypothesis, pool.found[hypothesis]), hypothesis, addable)


def _set_of(proposal: Proposal) -> Hypothesis:
    return Hypothesis(tuple(sorted(option.member for option in proposal.options)))


def of_simpler_form(pool: Pool, best: Hypothesis) -> list[Hypothesis]:
    """The sets that were fitted with a form of fewer parameters of a member's law, and explain less: what the other
    parameters take up may be one more effect beside it."""
    at = pool.found[best]
    enough = at.objective + chance_gain(at.count, at.data / at.count)
    return [one for one, result in pool if result.objective >= enough and has_simpler_form(one, best)]


def has_simpler_form(hypothesis: Hypothesis, best: Hypothesis) -> bool:
    """Whether a set is the best one with a form of fewer parameters in the place of one member's law."""
    own, replaced = (set(one.members) - set(other.members) for one, other in ((hypothesis, best), (best, hypothesis)))
    if len(own) != 1 or len(replaced) != 1:
        return False
    form, law = own.pop().effect, replaced.pop().effect
    return bool(form.kind) and form.kind == law.kind and len(form.parameters) < len(law.parameters)


def _compare(
    pool: Pool, step: str, hypothesis: Hypothesis, values: Mapping[str, float], states: Array, within: float,
    progress: Progress,
) -> None:  # fmt: skip
    """Fit a rival's own parameters, and then all that is free where it may come near."""
    if hypothesis in pool.hopeless or hypothesis in pool.excessive:
        return
    progress(f"comparing with {' + '.join(hypothesis.ids) or 'nothing'}")
    glanced = pool.glance(step, hypothesis, values, states, AT_FIRST)
    if glanced.objective < within + glanced.count:
        pool.try_set(step, hypothesis, glanced.values, glanced.states, FURTHER, give_up_above=within)
    else:
        pool.hopeless.add(hypothesis)


def in_a_members_place(
    pool: Pool, best: Hypothesis, columns: Sequence[Column], within: float
) -> Iterator[tuple[Hypothesis, dict[str, float]]]:
    """The set with another effect in a member's place: another form of its law, as large as it is; and of one that acts
    in an interval only, whatever else may act there; unless it was fitted to within so much of the best.

    A form of fewer parameters is tried wherever it leaves more than the best: beside friction that sticks chi^2 is
    rugged, and such a form may rest in a worse minimum.
    """
    at = pool.found[best]
    first = {column.effect.id: column for column in reversed(columns)}
    for member in best.members:
        rest, span = best.without(member), member.span(at.values)
        for column in first.values():
            effect = column.effect
            is_form = effect.kind != "" and effect.kind == member.effect.kind
            if effect.id == member.id or not rest.admits(effect) or not (is_form or span and effect.acting_names()):
                continue
            there = in_span(column, span) if span else column
            hypothesis = rest.with_effects([effect], there.limited)
            values = as_large(there, member, at) if is_form else there.values
            known = pool.found.get(hypothesis)
            if known is None or known.objective > (at.objective if has_simpler_form(hypothesis, best) else within):
                yield hypothesis, {**at.values, **neutral(member.effect), **values}


def as_large(column: Column, member: Member, result: Fit) -> dict[str, float]:
    """One form of a law with another's values where both have the parameter, and its other sizes in proportion to the
    first size that both have: the mean of the other form's where it has more sizes. A size that lies above another
    begins at that one, for there the form is the simpler one, which a fit can leave."""
    sizes = [row.name for row in column.effect.parameters if row.switches]
    theirs = {row.name: result.values[f"{member.id}.{row.name}"] for row in member.effect.parameters}
    of_theirs = [row.name for row in member.effect.parameters if row.switches]
    common = next((name for name in sizes if name in of_theirs), None)
    if common is None:
        return dict(column.values)
    if not set(of_theirs) <= set(sizes):
        theirs[common] = fmean(theirs[name] for name in of_theirs)
    share = theirs[common] / column.values[f"{column.effect.id}.{common}"]
    found = {}
    for name, value in column.values.items():
        own = base_name(name).rsplit(".", 1)[1]
        found[name] = theirs.get(own, share * value if own in sizes else value)
    above = {row.name: row.above for row in column.effect.parameters if row.above and row.name not in theirs}
    return found | {f"{column.effect.id}.{own}": found[f"{column.effect.id}.{other}"] for own, other in above.items()}


def refit_nominal(pool: Pool, calibrated: Fit, others: Sequence[Fit]) -> Fit:
    """The nominal model fitted once more from the best set's nominal values.

    A nominal fit that stopped in a flat valley would make any set that left it look like a discovery.
    """
    if not others:
        return calibrated
    best = min(others, key=lambda result: result.objective)
    names = {parameter.name for parameter in calibrated.free}
    values = {name: best.values[name] if name in names else value for name, value in calibrated.values.items()}
    again = fit(pool.problem, values, calibrated.free, best.states)
    return again if again.objective < calibrated.objective else calibrated
