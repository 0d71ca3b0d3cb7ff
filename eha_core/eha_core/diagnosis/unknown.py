"""A law outside the catalogue: recovered as a curve over whichever variable explains most."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError

from eha_core.curve import KNOTS
from eha_core.diagnosis.facts import Facts
from eha_core.diagnosis.tournament import Tournament, parameter_cost
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.freedom import Free
from eha_core.identification.observation import WITH_OIL
from eha_core.identification.problem import Problem, linearise, normal_equations
from eha_core.identification.shooting import Shooting

LEFT_OVER = 0.05
"""A curve is looked for when the best of the catalogue leaves this much chi^2 a sample beside noise."""

FULLY_FITTED = 2
"""How many of the curves that promise most are fitted in full."""

VARIABLES = {
    "recovered_force": ("position", "velocity", "pressure difference", "time"),
    "recovered_opening": ("spool position",),
    "recovered_leakage": ("pressure difference",),
}
"""What each curve can be over; a curve with several carries its choice in a parameter `variable`."""


@dataclass(frozen=True)
class Recovery:
    """The best curve: the effect that carries it, what it is over, its fit, and its score as of an `Entry`."""

    effect: Effect
    variable: str
    fit: Fit
    score: float
    share: float
    knots: tuple[tuple[float, float], ...]


def recover(
    problem: Problem, tournament: Tournament, facts: Facts, progress: Callable[[str], None] = lambda _: None
) -> Recovery | None:
    """Fit curves where the catalogue's best leaves something over; None where it does not, or no curve helps."""
    nominal = tournament.nominal.fit
    best = tournament.entries[0].fit if tournament.entries else nominal
    if best.data / best.count < 1.0 + LEFT_OVER or nominal.data / nominal.count < 1.0 + LEFT_OVER:
        return None
    progress("recovering an unknown law as a curve")
    promises = []
    for effect, variable, values in _curves(nominal.values, facts, problem.shooting):
        free = (*nominal.free, *_knots_free(effect, values, facts))
        promises.append((_promised(problem, nominal, values, free), effect, variable, values, free))
    promises.sort(key=lambda one: -one[0])
    found: list[Recovery] = []
    for gain, effect, variable, values, free in promises[:FULLY_FITTED]:
        if gain <= 0.0:
            continue
        progress(f"fitting {effect.id} over {variable}")
        result = fit(problem, values, free, nominal.states, iterations=10)
        variance = max(1.0, min(result.data / result.count, tournament.scatter))
        score = (nominal.objective - result.objective) / variance - KNOTS * parameter_cost(problem.count(), variance)
        share = (nominal.data - result.data) / max(nominal.data - nominal.count, 1.0)
        found.append(Recovery(effect, variable, result, score, float(np.clip(share, 0.0, 1.0)), _seen(effect, result)))
    return min(found, key=lambda one: one.fit.objective, default=None)


def _curves(
    values: Mapping[str, float], facts: Facts, shooting: Shooting
) -> Iterator[tuple[Effect, str, dict[str, float]]]:
    for effect in shooting.composition.effects:
        if effect.named or (shooting.drive not in WITH_OIL and effect.site != "force"):
            continue
        for place, variable in enumerate(VARIABLES[effect.id]):
            covered = _range(variable, facts)
            if covered is None:
                continue
            chosen = {**values, f"{effect.id}.lower": covered[0], f"{effect.id}.upper": covered[1]}
            if f"{effect.id}.variable" in values:
                chosen[f"{effect.id}.variable"] = float(place)
            yield effect, variable, chosen


def _range(variable: str, facts: Facts) -> tuple[float, float] | None:
    if variable == "time":
        return 0.0, facts.scales["time"][1]
    if variable == "position":
        centre, half = facts.scales["position"]
        return centre - half, centre + half
    if not len(facts.rows):
        speed = facts.scales["speed"][1]
        return (-2.5 * speed, 2.5 * speed) if variable == "velocity" else None
    if variable == "pressure difference":
        series = facts.column("pressure_a") - facts.column("pressure_b")
    else:
        series = facts.column({"velocity": "velocity", "spool position": "spool_position"}[variable])
    low, high = np.quantile(series, [0.002, 0.998])
    return float(low), float(high)


def _knots_free(effect: Effect, values: Mapping[str, float], facts: Facts) -> tuple[Free, ...]:
    if effect.site == "force":
        scale = facts.scales["force"][1]
    elif effect.site == "orifice":
        scale = facts.scales["spool"][1]
    else:
        scale = facts.scales["leakage_flow"][1] * facts.scales["pressure"][1]
    rows = zip(effect.parameter_names(), effect.parameters, strict=True)
    return tuple(
        Free(name, values[name], False, scale, 3.0, row.lower, row.upper) for name, row in rows if row.switches
    )


def _promised(problem: Problem, nominal: Fit, values: Mapping[str, float], free: tuple[Free, ...]) -> float:
    """The gain in chi^2 that the linearised problem with the curve promises."""
    q = np.array([one.coordinate(values[one.name]) for one in free])
    linear = linearise(problem, values, free, q, nominal.states)
    normal, gradient = normal_equations(problem, free, q, nominal.states, linear)
    try:
        return float(gradient @ normal.eliminate(1e-9).solve(gradient))
    except (LinAlgError, ValueError):
        return 0.0


def _seen(effect: Effect, result: Fit) -> tuple[tuple[float, float], ...]:
    """The curve's knots that the recording says something about."""
    lower, upper = result.values[f"{effect.id}.lower"], result.values[f"{effect.id}.upper"]
    places = np.linspace(lower, upper, KNOTS)
    found = []
    names = [one.name for one in result.free]
    for place, k in zip(places, range(KNOTS), strict=True):
        name = f"{effect.id}.knot_{k:02d}"
        index = names.index(name)
        if np.sqrt(max(result.covariance[index, index], 0.0)) < 0.5 * result.free[index].trust:
            found.append((float(place), float(result.values[name])))
    return tuple(found)
