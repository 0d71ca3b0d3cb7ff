"""Stages 5 and 6, model and show: the frozen result, assembled from the evidence, that every report presents."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from eha_core.diagnosis.calibrate import corrected_noise, filtered_channels
from eha_core.diagnosis.common_scale import common_scale
from eha_core.diagnosis.criteria import FAR_FROM_NOISE, LEAST_OF_A_LAW
from eha_core.diagnosis.each_recording import fitted_recordings, of_recording, predicted_recordings
from eha_core.diagnosis.event import event
from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.experiment.design import not_proposed, propose
from eha_core.diagnosis.experiment.discrimination import RATE
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.diagnosis.explained import explained, predictions
from eha_core.diagnosis.fitted_values import changed_values, fitted_parameters, named_effects
from eha_core.diagnosis.in_words import summary
from eha_core.diagnosis.ladder import correlation, ladder
from eha_core.diagnosis.law import UNITS as UNITS_OF_LAWS
from eha_core.diagnosis.law import express, weak_law
from eha_core.diagnosis.pictures import pictures
from eha_core.diagnosis.posterior import missed, probable_sets
from eha_core.diagnosis.result import (
    Alternative,
    ChannelFit,
    Diagnosis,
    Experiment,
    Explained,
    Location,
    NamedEffect,
    ProbableSet,
    UnknownLaw,
)
from eha_core.diagnosis.search.comparison import Entry
from eha_core.diagnosis.supported import one_sided, supported
from eha_core.diagnosis.undetected import undetected
from eha_core.diagnosis.verdict import Decision, contenders, whiteness
from eha_core.effects import effects as every_effect
from eha_core.health import Fault
from eha_core.identification.fit import Fit, fit, with_noise
from eha_core.identification.intervals import with_residual
from eha_core.identification.problem import Problem
from eha_core.identification.together import cut_together
from eha_core.identification.validate import channel_rmse, instants_of, judge, split
from eha_core.plausibility.finding import rescaled, topics_line
from eha_core.recording import Recording

FINAL_STEP = 1e-4
"""s; step size of the winner's final fit, so that its values and intervals do not depend on the search's larger one."""


def conclude(
    recordings: Sequence[Recording],
    evidence: Evidence,
    progress: Callable[[str], None] = lambda _: None,
    tests: Sequence[Recording] = (),
    limits: Limits | None = None,
) -> Diagnosis:
    """Refit the winner at the final step, score it on held-out data, and assemble the result.

    `limits`: those of the next experiment; by default the model's own.
    """
    progress("polishing the winner and its intervals")
    unknown = _unknown(evidence)
    decision = supported(evidence, _without_another_curve(evidence, unknown))
    evidence = replace(evidence, decision=decision)
    final = polish(evidence, decision.winner)
    nominal, recalibrated = evidence.calibration.nominal, evidence.comparison.nominal.fit
    training, held_out = _channel_fits(evidence, nominal, recalibrated, decision)
    left = explained(evidence, final, held_out)
    recording = recordings[evidence.lead - 1]
    shown = evidence.shown_fit(evidence.calibration.shooting, final)
    found = _findings(recording, evidence, final, None if decision.as_given else unknown, left, limits)
    return replace(
        found,
        damaged=next((record.damaged for record in recordings if record.damaged), None),
        training=of_recording(training, evidence.lead),
        held_out=of_recording(held_out, evidence.lead),
        prediction=predictions(evidence.observation, shown.values, evidence.calibration.shooting.step_size),
        together=fitted_recordings(evidence, final, held_out),
        tests=predicted_recordings(evidence, final, tests),
        correlation=correlation(final),
        trace=evidence.comparison.trace,
        health=_health(evidence),
    )


def _findings(
    recording: Recording, evidence: Evidence, final: Fit, unknown: UnknownLaw | None, left: Explained,
    limits: Limits | None,
) -> Diagnosis:  # fmt: skip
    """What is missing, where, and the evidence for it, in the recording that the report shows."""
    decision, comparison, composition = evidence.decision, evidence.comparison, evidence.observation.composition
    winner, before = decision.winner, evidence.calibration.nominal
    happened = _event(evidence, decision)
    parameters = fitted_parameters(final, evidence.nominal, composition)
    scale = common_scale(final, parameters) if decision.verdict == "parameters" else None
    steps, without = ladder(evidence, final)
    sets = probable_sets(comparison, winner)
    effects = _named(evidence, winner, final, sets, list(without))
    location = _law_site_first(unknown, evidence.location) if unknown else _ordered(evidence.location, winner)
    return Diagnosis(
        path=str(recording.path),
        duration=recording.duration,
        channels=evidence.observation.channels,
        not_examined=evidence.observation.not_examined,
        remarks=(*zeros_to_correct(effects, recording), *_remarks(evidence)),
        verdict=decision.verdict,
        summary=summary(decision, effects, unknown, left, happened, scale),
        location=location if decision.verdict not in ("consistent", "parameters") else (),
        parameters=parameters,
        effects=effects,
        alternatives=tuple(Alternative(entry.ids, gap) for entry, gap in decision.rivals),
        unknown=unknown,
        next_experiment=_experiment(evidence, decision, limits) if decision.verdict == "ambiguous" else None,
        rivals=tuple((entry.ids, entry.score) for entry in comparison.entries),
        whiteness=dict(zip(evidence.calibration.shooting.names, whiteness(winner.fit.residuals), strict=True)),
        fitted_values=changed_values(final, composition),
        pictures=pictures(evidence, before, comparison.nominal.fit, winner.fit),
        start_stamp=recording.start_stamp,
        explained=left,
        steps=steps,
        without=without,
        composition=composition,
        sets=sets,
        event=happened,
        scale=scale,
        undetected=undetected(evidence, left, parameters),
    )


def _named(
    evidence: Evidence, winner: Entry, final: Fit, sets: tuple[ProbableSet, ...], order: list[str]
) -> tuple[NamedEffect, ...]:
    """The named effects, in `order` where it is not empty."""
    ends = one_sided(evidence, final, winner)
    not_found = missed(evidence.comparison)
    effects = named_effects(winner, final, evidence.observation.composition, sets, ends, not_found)
    return tuple(sorted(effects, key=lambda effect: order.index(effect.id))) if order else effects


def _health(evidence: Evidence) -> tuple[tuple[int, Fault], ...]:
    """The faults of each recording, with its number."""
    return tuple(
        (number, fault) for number, observation in enumerate(evidence.observations, 1) for fault in observation.health
    )


def _event(evidence: Evidence, decision: Decision) -> tuple[float, float] | None:
    """The only interval [s] in which the nominal model fails in the recording shown; None without missing physics."""
    if decision.verdict in ("consistent", "parameters"):
        return None
    shooting = evidence.calibration.shooting
    fits = (evidence.calibration.nominal, decision.winner.fit)
    return event(evidence.shown(shooting), *(evidence.shown_fit(shooting, result) for result in fits))


def polish(evidence: Evidence, winner: Entry) -> Fit:
    """The winner fitted once more at the final step."""
    searched = evidence.calibration.shooting
    step_size = min(FINAL_STEP, searched.step_size)
    shooting = cut_together(evidence.observations, evidence.nominal, step_size, per_recording=searched.per_recording)
    # the winner's residual is closest to pure noise, so its roughness gives the best noise level
    shooting = with_noise(
        shooting, corrected_noise(evidence.calibration.shooting, winner.fit, filtered_channels(evidence.observations))
    )
    problem = Problem(shooting, np.arange(shooting.windows))
    final = fit(problem, winner.fit.values, winner.fit.free, winner.fit.states, iterations=4)
    if final.data > FAR_FROM_NOISE * final.count > winner.fit.data:
        # the smaller step ended in a worse minimum than the search's: iterate until it converges
        final = fit(problem, final.values, final.free, final.states, iterations=30)
    return with_residual(problem, final)


def _channel_fits(
    evidence: Evidence, before: Fit, calibrated: Fit, decision: Decision
) -> tuple[dict[str, ChannelFit], dict[str, ChannelFit]]:
    """RMSE of each channel of the nominal, recalibrated and augmented models, in training and in held-out windows."""
    shooting = evidence.calibration.shooting
    judged_nominal = decision.judged_nominal or judge(shooting, calibrated)
    judged_winner = decision.judged_winner or judged_nominal
    training, judged = split(shooting, instants_of(decision.winner.fit))
    parts = (
        (channel_rmse(training, before.residuals), judged_nominal.training, judged_winner.training),
        (channel_rmse(judged, before.residuals), judged_nominal.held_out, judged_winner.held_out),
    )
    noise = {name: sampling.noise for name, sampling in zip(shooting.names, shooting.samplings, strict=True)}
    made = [
        {name: ChannelFit(first[name], second[name], third[name], noise[name]) for name in shooting.names}
        for first, second, third in parts
    ]
    return made[0], made[1]


def zeros_to_correct(effects: Iterable[NamedEffect], recording: Recording) -> Iterator[str]:
    """The topics-file line for each named zero offset of a sensor: a channel with another origin looks the same."""
    declared = {effect.id: dict(effect.zeros) for effect in every_effect()}
    for effect in effects:
        if effect.active is not None:
            continue  # a zero that moved during the recording is no mistake in reading it
        shifts = {channel: -effect.parameters[name].value for name, channel in declared[effect.id].items()}
        read = {channel: rescaled(recording, channel, 1.0, float(f"{shift:.4g}")) for channel, shift in shifts.items()
                if shift and channel in recording.channels}  # fmt: skip
        if read:
            what = " and ".join(read)
            yield f"if only the zero of {what} is off, a topics file (--topics) corrects it: `{topics_line(read)}`"


def _remarks(evidence: Evidence) -> tuple[str, ...]:
    """Corrections made to each recording, of several with its path; and a search that began anew."""
    what = []
    if evidence.observation.composition.cylinder.motion == "rad":
        what.append("the actuator is rotary: read rad, rad/s and N m in place of the channels' m, m/s and N")
    if evidence.decision.winner.effects and (not_found := missed(evidence.comparison)):
        what.append(
            "short windows did not show what is missing, and it was sought anew over longer ones: in simulated"
            f" recordings {not_found:.0%} of such diagnoses had an effect wrong; a second test tells"
        )
    if len(evidence.observations) == 1:
        return (*what, *evidence.observation.remarks)
    return (
        *what,
        *(f"{observation.path}: {remark}" for observation in evidence.observations for remark in observation.remarks),
    )


def _ordered(location: tuple[Location, ...], winner: Entry) -> tuple[Location, ...]:
    """The named effects' sites first, each with its effect's active interval: a certain name makes both certain."""
    sites = {effect.site for effect in winner.effects}
    always = {member.effect.site for member in winner.hypothesis.members if not member.limited}
    limited = (member for member in winner.hypothesis.limited if member.effect.site not in always)
    spans = {member.effect.site: member.span(winner.fit.values) for member in limited}
    location = tuple(
        place if (span := spans.get(place.site)) is None else replace(place, when=(span,)) for place in location
    )
    return tuple(sorted(location, key=lambda place: (place.site not in sites, -place.share)))


def _unknown(evidence: Evidence) -> UnknownLaw | None:
    """The recovered law of an unknown effect; None where its R^2 is below LEAST_OF_A_LAW."""
    if evidence.decision.verdict != "unknown_physics":
        return None
    law = _best_law(evidence)
    return law if law is not None and law.r_squared >= LEAST_OF_A_LAW else None


def _best_law(evidence: Evidence) -> UnknownLaw | None:
    """The law regressed on the equation residuals, or the simulated curve where that explains more.

    The residuals identify the site; a curve at another site only compensates for the law.
    """
    law, curve = weak_law(evidence.equation_residuals), evidence.recovery
    if curve is not None and curve.named:
        law = None  # the equation residuals also contain the named effects
    if curve is not None and (law is None or (curve.effect.site == law.site and curve.share > law.r_squared)):
        x, y = np.array(curve.knots, dtype=np.float64).reshape(-1, 2).T
        over, _, times = curve.variable.partition(", times ")
        unit = UNITS_OF_LAWS[curve.effect.site] + (" s/m" if times == "velocity" else "")
        text = express(x, y, over, unit).text
        if not text and law is not None and law.function_of == curve.variable:
            text = law.expression
        return UnknownLaw(curve.effect.site, curve.variable, text, curve.share, curve.knots)
    return law


def _without_another_curve(evidence: Evidence, unknown: UnknownLaw | None) -> Decision:
    """The decision, with the recalibrated model as winner where its curve is not the law that was found."""
    decision, curve = evidence.decision, evidence.recovery
    if decision.verdict != "unknown_physics" or curve is None:
        return decision
    if unknown is not None and (unknown.site, unknown.function_of) == (curve.effect.site, curve.variable):
        return decision
    return replace(decision, winner=evidence.comparison.nominal, judged_winner=decision.judged_nominal)


def _law_site_first(law: UnknownLaw, location: tuple[Location, ...]) -> tuple[Location, ...]:
    """The law's site first, however well effects of other sites could compensate for the law."""
    where, when = (location[0].where, location[0].when) if location else ("all over the states that were visited", ())
    others = (place for place in location if place.site != law.site)
    return (Location(law.site, law.r_squared, where, when, law.function_of), *others)


def _experiment(evidence: Evidence, decision: Decision, limits: Limits | None) -> Experiment:
    """The test that would distinguish the rivals; for a source that no voltage drives, why there is none."""
    source = evidence.observation.composition.source
    if source.valve != "coil":
        names = [entry.ids for entry in contenders(decision.winner, evidence.comparison)]
        return not_proposed(names, evidence.observation.driving, source.id)
    shooting, values = evidence.shown(evidence.calibration.shooting), decision.winner.fit.values
    noises = {
        name: sampling.noise * float(np.sqrt(RATE * evidence.observation.duration / len(sampling.values)))
        for name, sampling in zip(shooting.names, shooting.samplings, strict=True)
    }
    limit = values["saturation_current"] * values["coil_resistance"]
    if limits is not None:
        limit = min(limit, limits.voltage)
    used = float(np.std(shooting.inputs[0])) if evidence.observation.drive == "voltage" else 0.0
    rivals = [(entry.ids, entry.fit) for entry in contenders(decision.winner, evidence.comparison)]
    return propose(rivals, noises, used or 0.1 * limit, limit, limits)
