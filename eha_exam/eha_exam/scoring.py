"""What an opened diagnosis is worth: right, abstained or wrong, by rules stated before anything was diagnosed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np

from eha_exam.case import Case
from eha_exam.concealed import EQUIVALENT, SITES
from eha_exam.outside import curve_agreement
from eha_exam.truth.record import OUTSIDE

OUTCOMES = ("right", "abstained", "wrong", "failed")
DISCOVERIES = ("missing_physics", "unknown_physics")
NORMAL_95 = 1.959963984540054

LEFT = 1.5
"""Times the noise above which no explanation is complete."""


@dataclass(frozen=True)
class Answer:
    """What a tool returned for one recording: its diagnosis (None where it made none), exit status and time [s]."""

    diagnosis: Mapping[str, Any] | None
    status: int
    seconds: float
    message: str = ""


@dataclass(frozen=True)
class Mark:
    """The score of one case.

    `outcome` is one of OUTCOMES. `site_right`: the site named first is one where something is concealed (None where
    nothing is). `in_stated_set`: an ambiguous verdict lists the truth (None for other verdicts). `discovery`: physics
    was claimed where none is missing. `intervals`: for each parameter of a rightly named effect in the catalogue's own
    law, whether its 95 % interval holds the truth. `nominal_intervals`: the same for the rig's parameters. Both where
    nothing concealed is unnamed.
    `held_out_ratio`: held-out error after over noise, worst channel. `curve_r_squared`: agreement of a recovered law.
    `resolved`: whether the test that an ambiguous verdict prescribed led to the truth. `seen`: of what is concealed,
    the effects that the recording can show beside the others. `false`: what is named and not concealed, under no name.
    `complete`: what the diagnosis says of itself. `probabilities`: of each name, the one stated and whether the effect
    is concealed. `collection`: how many sets are stated to hold 95 % of the probability, and whether one is the truth
    (None where none is stated, or the law is in no catalogue).
    """

    name: str
    tier: str
    noise: float
    concealed: tuple[str, ...]
    verdict: str
    named: tuple[str, ...]
    outcome: str
    site_right: bool | None
    in_stated_set: bool | None
    discovery: bool
    intervals: tuple[bool, ...]
    nominal_intervals: tuple[bool, ...]
    held_out_ratio: float | None
    curve_r_squared: float | None
    seconds: float
    decidable: bool
    resolved: bool | None = None
    seen: tuple[str, ...] = ()
    false: tuple[str, ...] = ()
    complete: bool | None = None
    probabilities: tuple[tuple[float, bool], ...] = ()
    collection: tuple[int, bool] | None = None

    @property
    def exact(self) -> bool:
        """Whether the effects named are those concealed, or all of those that can be seen."""
        return set(self.seen or self.concealed) <= set(self.named) <= set(self.concealed)

    @property
    def truthful(self) -> bool | None:
        """Whether `complete` is true where, and only where, no channel has more than LEFT times the noise left on
        held-out data; None where it cannot be said."""
        if self.complete is None or self.held_out_ratio is None:
            return None
        return not (self.complete and self.held_out_ratio > LEFT)


def mark(case: Case, answer: Answer, second: Answer | None = None) -> Mark:
    """Score one answer, and that to both recordings where an ambiguous one prescribed a second."""
    diagnosis = answer.diagnosis or {}
    verdict = str(diagnosis.get("verdict", "none"))
    named = tuple(str(effect["id"]) for effect in diagnosis.get("effects") or ())
    outcome = _outcome(case, verdict, named, diagnosis)
    held = outcome == "right" and _nothing_unnamed(case, verdict, named)
    false = tuple(name for name in named if not any(name in names for names in accepted(case)))
    plain = not any("law" in values or "rounding" in values or "underlap" in values for _, values in case.effects)
    return Mark(
        name=case.name,
        tier=case.tier,
        noise=case.noise,
        concealed=case.effect_ids,
        verdict=verdict,
        named=named,
        outcome=outcome,
        site_right=_site_right(case, diagnosis),
        in_stated_set=_in_stated_set(case, diagnosis) if verdict == "ambiguous" else None,
        discovery=not case.effects and verdict in DISCOVERIES,
        intervals=_effect_intervals(case, diagnosis) if held and plain else (),
        nominal_intervals=_nominal_intervals(case, diagnosis) if held and not case.windows else (),
        held_out_ratio=_held_out_ratio(diagnosis),
        curve_r_squared=_curve(case, diagnosis),
        seconds=answer.seconds,
        decidable=case.decidable,
        resolved=_resolved(case, second) if verdict == "ambiguous" else None,
        seen=case.seen,
        false=false,
        complete=(diagnosis.get("explained") or {}).get("complete"),
        probabilities=tuple(
            (float(effect["probability"]), effect["id"] not in false)
            for effect in diagnosis.get("effects") or ()
            if effect.get("probability") is not None
        ),
        collection=_collection(case, diagnosis),
    )


def _resolved(case: Case, second: Answer | None) -> bool:
    """Whether the prescribed test, once run, led to the truth; none prescribed resolves nothing."""
    diagnosis = (second.diagnosis if second is not None else None) or {}
    named = {str(effect["id"]) for effect in diagnosis.get("effects") or ()}
    if not case.effects:
        return diagnosis.get("verdict") in ("consistent", "parameters")
    return diagnosis.get("verdict") == "missing_physics" and named in accepted(case)


def _outcome(case: Case, verdict: str, named: Sequence[str], diagnosis: Mapping[str, Any]) -> str:
    """The rule. Abstaining is "ambiguous" with the truth in the stated set, or seeing nothing of what is concealed.

    Where the recording cannot hold enough to tell (an oracle that knows the form gains too little), not naming anything
    is right, and so is leaving out of several effects those that cannot be seen beside the others. Where it cannot tell
    the truth from a rival, the right answer is to say so: a name is a guess, and wrong even when lucky. An effect that
    acts over an interval may be located without a name, which is to abstain. Nothing missing: "consistent" and
    "parameters" claim no physics, and either is right.
    """
    if verdict == "none":
        return "failed"
    silent = verdict in ("consistent", "parameters")
    if not case.effects:
        return "right" if silent else "abstained" if verdict == "ambiguous" else "wrong"
    if case.tier == "named_and_unknown":
        return _named_and_unknown(case, verdict, named, diagnosis)
    if verdict == "unknown_physics" and case.windows:
        return "abstained" if _site_right(case, diagnosis) else "wrong"
    if verdict == case.verdict == "unknown_physics":
        return "right" if _site_right(case, diagnosis) else "wrong"
    if verdict == "missing_physics":
        return "right" if _is_told(case, set(named)) and not case.rivals else "wrong"
    if verdict == "ambiguous":
        if not _in_stated_set(case, diagnosis):
            return "wrong"
        return "right" if case.rivals else "abstained"
    if silent:
        return "abstained" if case.decidable or case.seen else "right"
    return "wrong"


def _is_told(case: Case, named: set[str]) -> bool:
    """Whether these are the effects concealed, or of those all that can be seen beside the others."""
    all_seen = not case.decidable and set(case.seen) <= named < set(case.effect_ids)
    return named in accepted(case) or all_seen


def _named_and_unknown(case: Case, verdict: str, named: Sequence[str], diagnosis: Mapping[str, Any]) -> str:
    """One effect of the catalogue and one law outside of it: right where both are distinguished, or named where effects
    of the catalogue express that law; abstained where a site of theirs is located and nothing false is named."""
    if verdict == "missing_physics" and set(named) in accepted(case):
        return "right"
    known = {name for name in case.effect_ids if name not in OUTSIDE}
    if verdict == "unknown_physics" and set(named) <= known and _site_right(case, diagnosis):
        return "right" if named else "abstained"
    return "wrong"


def accepted(case: Case) -> list[set[str]]:
    """The sets of effects that name what is concealed: its own, and what the catalogue calls the very same law."""
    own = set(case.effect_ids)
    known_as = {other for name in own for other in EQUIVALENT.get(name, (name,))}
    return [own] if known_as == own else [own, known_as]


def _nothing_unnamed(case: Case, verdict: str, named: Sequence[str]) -> bool:
    """Whether the diagnosis describes all that is concealed, so that its parameters mean what the rig's do: a scale of
    the position sensor that cannot be identified makes every length and speed another."""
    return not case.effects or verdict == "unknown_physics" or set(named) in accepted(case)


def _in_stated_set(case: Case, diagnosis: Mapping[str, Any]) -> bool:
    stated = [{str(effect["id"]) for effect in diagnosis.get("effects") or ()}]
    stated += [set(option["effects"]) for option in diagnosis.get("alternatives") or ()]
    return any(_is_told(case, names) for names in stated)


def _collection(case: Case, diagnosis: Mapping[str, Any]) -> tuple[int, bool] | None:
    sets = [set(one["effects"]) for one in diagnosis.get("sets") or ()]
    if not sets or case.verdict == "unknown_physics":
        return None
    return len(sets), any(_is_told(case, names) for names in sets)


def _site_right(case: Case, diagnosis: Mapping[str, Any]) -> bool | None:
    if not case.effects or not diagnosis:
        return None
    unknown = diagnosis.get("unknown")
    if unknown:
        return unknown["site"] in case.sites
    effects = diagnosis.get("effects") or ()
    if effects:
        return any(SITES.get(effect["id"], effect["site"]) in case.sites for effect in effects)
    location = list(diagnosis.get("location") or [])
    return bool(location) and location[0]["site"] in case.sites


def _holds(value: float, std: float, truth: float) -> bool:
    return abs(value - truth) <= NORMAL_95 * std


def _effect_intervals(case: Case, diagnosis: Mapping[str, Any]) -> tuple[bool, ...]:
    truth = dict(case.effects)
    held = []
    for effect in diagnosis.get("effects") or ():
        for name, fitted in (effect.get("parameters") or {}).items():
            # an equivalent law of the catalogue has parameters of its own, which the truth does not know
            value = truth.get(effect["id"], {}).get(name)
            found, std = fitted.get("value"), fitted.get("std")
            if isinstance(value, float) and abs(value) < 1.0e30 and std and found is not None:
                held.append(_holds(found, std, value))
    return tuple(held)


def _nominal_intervals(case: Case, diagnosis: Mapping[str, Any]) -> tuple[bool, ...]:
    return tuple(
        _holds(row["fitted"], row["std"], case.plant[row["name"]])
        for row in diagnosis.get("parameters") or ()
        if row["name"] in case.plant and row.get("std") and row.get("fitted") is not None
    )


def _held_out_ratio(diagnosis: Mapping[str, Any]) -> float | None:
    channels = (diagnosis.get("fit") or {}).get("held_out") or {}
    fits = [fit for fit in channels.values() if fit.get("noise") and fit.get("rmse_after") is not None]
    ratios = [fit["rmse_after"] / fit["noise"] for fit in fits]
    return max(ratios) if ratios else None


def _curve(case: Case, diagnosis: Mapping[str, Any]) -> float | None:
    unknown = diagnosis.get("unknown")
    if not unknown or len(case.effects) != 1:
        return None
    samples = np.asarray(unknown.get("samples") or np.zeros((0, 2)), dtype=float)
    return curve_agreement(case, str(unknown.get("function_of")), samples)


@dataclass(frozen=True)
class Proportion:
    """A count of successes with Wilson's 95 % interval."""

    successes: int
    trials: int

    @property
    def value(self) -> float | None:
        """The share, None of no trials."""
        return self.successes / self.trials if self.trials else None

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95 % score interval."""
        return wilson(self.successes, self.trials)

    def __str__(self) -> str:
        if not self.trials:
            return "-"
        share, low, high = (100.0 * part for part in (self.successes / self.trials, *self.interval))
        return f"{self.successes}/{self.trials} = {share:.1f} % ({low:.1f} to {high:.1f})"


def wilson(successes: int, trials: int, z: float = NORMAL_95) -> tuple[float, float]:
    """Wilson's score interval of a proportion (E. B. Wilson, JASA 22, 1927); (0, 1) of no trials."""
    if trials == 0:
        return 0.0, 1.0
    share = successes / trials
    spread = z * sqrt(share * (1.0 - share) / trials + z * z / (4.0 * trials * trials))
    centre = share + z * z / (2.0 * trials)
    scale = 1.0 + z * z / trials
    return max(0.0, (centre - spread) / scale), min(1.0, (centre + spread) / scale)
