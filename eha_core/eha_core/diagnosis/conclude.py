"""Stages 5 and 6, model and show: the evidence turned into the frozen result that the presenters know."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from eha_core.diagnosis.calibrate import corrected_noise, has_changed, identifiable
from eha_core.diagnosis.criteria import FAR_FROM_NOISE, LEAST_OF_A_LAW
from eha_core.diagnosis.discrimination import RATE
from eha_core.diagnosis.each_recording import fitted_recordings, of_recording, predicted_recordings
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.experiment import not_proposed, propose
from eha_core.diagnosis.explained import explained, predictions
from eha_core.diagnosis.facts import facts_alone
from eha_core.diagnosis.ladder import correlation, ladder
from eha_core.diagnosis.law import UNITS as UNITS_OF_LAWS
from eha_core.diagnosis.law import express, weak_law
from eha_core.diagnosis.locate import stated
from eha_core.diagnosis.model_comparison import Entry
from eha_core.diagnosis.result import (
    Alternative,
    ChannelFit,
    Diagnosis,
    Experiment,
    FittedParameter,
    FittedValue,
    Location,
    NamedEffect,
    Pictures,
    UnknownLaw,
)
from eha_core.diagnosis.search.prune import wald
from eha_core.diagnosis.summary import summary
from eha_core.diagnosis.verdict import Decision, contenders, whiteness
from eha_core.effects import SITES, Effect
from eha_core.identification.fit import Fit, fit, with_noise
from eha_core.identification.intervals import with_residual
from eha_core.identification.numbers import Array
from eha_core.identification.per_recording import base_name, is_one_of
from eha_core.identification.problem import Problem
from eha_core.identification.shooting import Shooting
from eha_core.identification.together import cut_together
from eha_core.identification.validate import channel_rmse, instants_of, judge, split
from eha_core.plant import Composition
from eha_core.recording import Recording

FINAL_STEP = 1e-4
"""s; the winner is fitted once more at this step, so that its parameters and intervals owe nothing to the coarser
one."""


def conclude(
    recordings: Sequence[Recording],
    evidence: Evidence,
    progress: Callable[[str], None] = lambda _: None,
    tests: Sequence[Recording] = (),
) -> Diagnosis:
    """Polish the winner, measure what it is worth on data it was not fitted to, and put everything into words."""
    progress("polishing the winner and its intervals")
    unknown = _unknown(evidence)
    decision = _without_another_curve(evidence, unknown)
    final = polish(evidence, decision.winner)
    left = explained(replace(evidence, decision=decision), final)
    before, calibrated = evidence.calibration.nominal, evidence.comparison.nominal.fit
    training, held_out = _channel_fits(evidence, before, calibrated, decision)
    composition = evidence.observation.composition
    experiment = _experiment(evidence, decision) if decision.verdict == "ambiguous" else None
    recording = recordings[evidence.lead - 1]
    steps, without = ladder(replace(evidence, decision=decision), final)
    order = [one.added for one in steps]
    effects = _named(decision.winner, final, composition)
    effects = tuple(sorted(effects, key=lambda one: order.index(one.id)))
    location = _led_by(unknown, evidence.location) if unknown else _ordered(evidence.location, decision.winner)
    return Diagnosis(
        path=str(recording.path),
        duration=recording.duration,
        channels=evidence.observation.channels,
        not_examined=evidence.observation.not_examined,
        remarks=_remarks(evidence),
        damaged=next((one.damaged for one in recordings if one.damaged), None),
        verdict=decision.verdict,
        summary=summary(decision, effects, unknown, left),
        location=location if decision.verdict not in ("consistent", "parameters") else (),
        parameters=_parameters(final, evidence.nominal, composition),
        effects=effects,
        alternatives=tuple(Alternative(entry.ids, gap) for entry, gap in decision.rivals),
        unknown=unknown,
        training=of_recording(training, evidence.lead),
        held_out=of_recording(held_out, evidence.lead),
        next_experiment=experiment,
        rivals=tuple((entry.ids, entry.score) for entry in evidence.comparison.entries),
        whiteness=dict(zip(evidence.calibration.shooting.names, whiteness(decision.winner.fit.residuals), strict=True)),
        fitted_values=_changed_values(final, composition),
        pictures=_pictures(evidence, before, calibrated, decision.winner.fit),
        start_stamp=recording.start_stamp,
        explained=left,
        prediction=predictions(
            evidence.observation,
            evidence.shown_fit(evidence.calibration.shooting, final).values,
            evidence.calibration.shooting.step_size,
        ),
        together=fitted_recordings(evidence, final, held_out),
        tests=predicted_recordings(evidence, final, tests),
        steps=steps,
        without=without,
        correlation=correlation(final),
        composition=composition,
    )


def polish(evidence: Evidence, winner: Entry) -> Fit:
    """The winner fitted once more at the final step."""
    searched = evidence.calibration.shooting
    step_size = min(FINAL_STEP, searched.step_size)
    shooting = cut_together(evidence.observations, evidence.nominal, step_size, per_recording=searched.per_recording)
    # under the winner the residual is noise at last, so its roughness is measured best there
    shooting = with_noise(shooting, corrected_noise(evidence.calibration.shooting, winner.fit))
    problem = Problem(shooting, np.arange(shooting.windows))
    final = fit(problem, winner.fit.values, winner.fit.free, winner.fit.states, iterations=4)
    if final.data > FAR_FROM_NOISE * final.count > winner.fit.data:
        # the finer step met a worse valley than the search had left: go on to its end
        final = fit(problem, final.values, final.free, final.states, iterations=30)
    return with_residual(problem, final)


def _channel_fits(
    evidence: Evidence, before: Fit, calibrated: Fit, decision: Decision
) -> tuple[dict[str, ChannelFit], dict[str, ChannelFit]]:
    """RMSE of every channel before, calibrated and after, on the windows fitted to and on those held out."""
    shooting = evidence.calibration.shooting
    judged_nominal = decision.judged_nominal or judge(shooting, calibrated)
    judged_winner = decision.judged_winner or judged_nominal
    training, judged = split(shooting, instants_of(decision.winner.fit))
    parts = (
        (channel_rmse(training, before.residuals), judged_nominal.training, judged_winner.training),
        (channel_rmse(judged, before.residuals), judged_nominal.held_out, judged_winner.held_out),
    )
    noise = {name: one.noise for name, one in zip(shooting.names, shooting.samplings, strict=True)}
    made = [
        {name: ChannelFit(first[name], second[name], third[name], noise[name]) for name in shooting.names}
        for first, second, third in parts
    ]
    return made[0], made[1]


def _remarks(evidence: Evidence) -> tuple[str, ...]:
    """What was put right in each recording; of several, each with its path."""
    turns = evidence.observation.composition.cylinder.motion == "rad"
    what = ("the actuator turns: for m, m/s and N of the channels read rad, rad/s and N m",) if turns else ()
    if len(evidence.observations) == 1:
        return (*what, *evidence.observation.remarks)
    return (*what, *(f"{one.path}: {remark}" for one in evidence.observations for remark in one.remarks))


def _parameters(final: Fit, nominal: Mapping[str, float], composition: Composition) -> tuple[FittedParameter, ...]:
    rows = composition.place_rows
    found = []
    for one in final.free:
        base = base_name(one.name)
        if base not in rows:
            continue
        note = "" if identifiable(final, one.name) else "this recording does not tell it; held near its nominal value"
        at_bound = one.is_bound_by(final.values[one.name])
        if at_bound:
            note = "at the bound of what is believed of it: its interval does not count"
        found.append(
            FittedParameter(
                one.name,
                nominal[base],
                final.values[one.name],
                final.deviation(one.name),
                rows[base].unit,
                has_changed(final, nominal, one.name),
                note,
                at_bound,
            )
        )
    return tuple(found)


def _named(winner: Entry, final: Fit, composition: Composition) -> tuple[NamedEffect, ...]:
    found = []
    for member in (one for one in winner.hypothesis.members if one.effect.named):
        effect = composition.as_shown(member.effect)
        values = {
            row.name: FittedValue(final.values[name], final.deviation(name), row.unit)
            for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)
        }
        values |= _in_other_recordings(effect, final)
        active = winner.span if member.limited else None
        statement = effect.describe({name: value.value for name, value in values.items()})
        statement += f", from {active[0]:.4g} s to {active[1]:.4g} s only" if active else ""
        evidence = winner.score if len(winner.effects) == 1 else wald(final, effect)
        row = NamedEffect(effect.id, effect.site, effect.equation, values, evidence, statement, active, effect.kind)
        found.append(row)
    return tuple(found)


def _in_other_recordings(effect: Effect, final: Fit) -> dict[str, FittedValue]:
    """The values of an effect's parameters that differ between recordings, in all but the first: `force@2`."""
    units = {name: row.unit for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)}
    return {
        one.name.removeprefix(f"{effect.id}."): FittedValue(
            final.values[one.name], final.deviation(one.name), units[base_name(one.name)]
        )
        for one in final.free
        if "@" in one.name and is_one_of(one.name, units)
    }


def _ordered(location: tuple[Location, ...], winner: Entry) -> tuple[Location, ...]:
    """The named effect's site first: where the name is certain, so is the site, and when it acts."""
    sites = {effect.site for effect in winner.effects}
    if winner.span:
        location = tuple(_in_span(one, winner.span) if one.site in sites else one for one in location)
    return tuple(sorted(location, key=lambda one: (one.site not in sites, -one.share)))


def _in_span(one: Location, span: tuple[float, float]) -> Location:
    return replace(one, when=(span,), statement=stated(one.site, one.share, one.where, (span,)))


def _unknown(evidence: Evidence) -> UnknownLaw | None:
    """The law that no name fits, if there is one that explains more than it leaves."""
    if evidence.decision.verdict != "unknown_physics":
        return None
    law = _best_law(evidence)
    return law if law is not None and law.r_squared >= LEAST_OF_A_LAW else None


def _best_law(evidence: Evidence) -> UnknownLaw | None:
    """The law as the weak balances hold it, or as the simulated curve where that explains more.

    The balances tell the site; a curve of another site only makes up for what it does not describe.
    """
    law, curve = weak_law(evidence.balances), evidence.recovery
    if curve is not None and curve.named:
        law = None  # the balances lack what is named, too
    if curve is not None and (law is None or (curve.effect.site == law.site and curve.share > law.r_squared)):
        x, y = np.array(curve.knots, dtype=np.float64).reshape(-1, 2).T
        text = express(x, y, curve.variable, UNITS_OF_LAWS[curve.effect.site]).text
        if not text and law is not None and law.function_of == curve.variable:
            text = law.expression
        return UnknownLaw(curve.effect.site, curve.variable, text, curve.share, curve.knots)
    return law


def _without_another_curve(evidence: Evidence, unknown: UnknownLaw | None) -> Decision:
    """The decision, on the nominal equations where its curve is not the law that was found."""
    decision, curve = evidence.decision, evidence.recovery
    if decision.verdict != "unknown_physics" or curve is None:
        return decision
    if unknown is not None and (unknown.site, unknown.function_of) == (curve.effect.site, curve.variable):
        return decision
    return replace(decision, winner=evidence.comparison.nominal, judged_winner=decision.judged_nominal)


def _led_by(law: UnknownLaw, location: tuple[Location, ...]) -> tuple[Location, ...]:
    """The law's site first, whatever effects of other sites could make up for."""
    where, when = (location[0].where, location[0].when) if location else ("all over the states that were visited", ())
    statement = f"{law.r_squared:.0%} of what is missing {SITES[law.site].words} is a law over {law.function_of}"
    others = (one for one in location if one.site != law.site)
    return (Location(law.site, law.r_squared, where, when, statement), *others)


def _changed_values(final: Fit, composition: Composition) -> dict[str, float]:
    """What a simulator needs beside the nominal values of such an actuator to be the fitted plant."""
    nominal = composition.places(composition.nominal_values())
    return {name: final.values[name] for name in nominal if final.values[name] != nominal[name]}


def _experiment(evidence: Evidence, decision: Decision) -> Experiment:
    """The test that would tell the rivals apart; of a source that no voltage drives, why there is none."""
    source = evidence.observation.composition.source
    if source.valve != "coil":
        names = [entry.ids for entry in contenders(decision.winner, evidence.comparison)]
        return not_proposed(names, evidence.observation.driving, source.id)
    shooting, values = evidence.shown(evidence.calibration.shooting), decision.winner.fit.values
    noises = {
        name: one.noise * float(np.sqrt(RATE * evidence.observation.duration / len(one.values)))
        for name, one in zip(shooting.names, shooting.samplings, strict=True)
    }
    limit = values["saturation_current"] * values["coil_resistance"]
    used = float(np.std(shooting.inputs[0])) if evidence.observation.drive == "voltage" else 0.0
    rivals = [(entry.ids, entry.fit) for entry in contenders(decision.winner, evidence.comparison)]
    return propose(rivals, noises, used or 0.1 * limit, limit)


def _pictures(evidence: Evidence, before: Fit, calibrated: Fit, after: Fit) -> Pictures:
    """Series for the report: measured channels and the three models' at the same times, windows restarted."""
    whole = evidence.calibration.shooting
    shooting = evidence.shown(whole)
    models = [_modelled(shooting, evidence.shown_fit(whole, one)) for one in (before, calibrated, after)]
    times = {name: shooting.times(one) for name, one in zip(shooting.names, shooting.samplings, strict=True)}
    measured = {name: one.values for name, one in zip(shooting.names, shooting.samplings, strict=True)}
    variables: dict[str, Array] = {}
    facts = facts_alone(whole, evidence.facts, evidence.lead)
    if len(facts.rows):
        for name in ("velocity", "spool_position", "position", "pressure_a", "pressure_b"):
            variables[name] = facts.column(name)
        variables["time"] = np.asarray((np.arange(len(facts.rows)) + 1) * shooting.every * shooting.step_size)
    if evidence.observation.drive == "voltage":
        times["voltage_command"], measured["voltage_command"] = evidence.observation.inputs[0]
    equations = {one.equation: (one.time, one.residual) for one in evidence.equations}
    outside = split(whole, instants_of(after))[1]
    lead = whole.recordings[evidence.lead - 1]
    spans = whole.local_edges.tolist()
    judged = tuple((spans[window][0], spans[window][1]) for window in outside.windows if window in lead)
    return Pictures(times, measured, models[0], models[1], models[2], variables, equations, judged)


def _modelled(shooting: Shooting, result: Fit) -> dict[str, Array]:
    pairs = zip(shooting.names, shooting.samplings, result.residuals, strict=True)
    return {name: one.values - residual * one.noise for name, one, residual in pairs}
