"""Whether a designed test moves a rig past its limits: drawn rigs, nominal values that are off, concealed effects.

    python -m tools.limit_trials --rigs 1000 --seed S --out FILE [--first K] [--jobs 2]

Each rig is drawn as the exam draws it, with up to six effects that its model does not have. A signal of `eha detect`'s
is drawn, with the largest amplitude at which no rig within the model's priors exceeds a limit, or a share of that. Then
the exam's truth, which shares no code with the model, is driven with it as `investigate` drives a rig: a watch looks at
each measured sample, and stops the motion where a limit is in sight. A line of FILE is one rig.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from eha_core.detectability.design import SHARES, kinds
from eha_core.detectability.margins import Margins
from eha_core.diagnosis.experiment.limits import Limits, limits_of
from eha_core.errors import EhaError
from eha_core.investigation import Watch
from eha_core.nominal import nominal_of
from eha_exam.case import POSITION_NOISE, PRESSURE_NOISE, Array, Case
from eha_exam.drawing import draw_case
from eha_exam.plants import Rig
from eha_exam.truth.simulate import COLUMNS, SteppedTruth
from tools.trial_rows import try_rigs

TIERS = ("null_parameters", "single", "pair", "three", "rig")
"""Whose rigs are drawn in turn: with none, one, two, three, and four to six effects."""

SPEEDS = (0.3, 1.0)
"""Of the rig's top speed, between which its limit of speed is drawn."""

DURATION, RATE = 10.0, 500.0
"""s and Hz of a test."""

AFTER = 0.5
"""s that a motion is followed after it was stopped."""


def try_rig(number: int, seed: int) -> dict[str, Any]:
    """One rig and test: the largest share of each limit that the truth reached, and why the watch stopped it, if so."""
    generator = np.random.default_rng([seed, number])
    case = draw_case(TIERS[number % len(TIERS)], number, seed)
    model = nominal_of(dict(case.nominal))
    speed = float(generator.uniform(*SPEEDS)) * Rig(case.family, case.nominal).top_speed
    limits = replace(limits_of(model.values), speed=speed)
    kind = str(generator.choice(list(kinds())))
    make = kinds()[kind][int(generator.integers(len(kinds()[kind])))]
    times = np.arange(round(DURATION * RATE)) / RATE
    row: dict[str, Any] = {"number": number, "concealed": list(case.effect_ids), "kind": kind}
    try:
        largest = Margins.of(model, limits).largest_amplitude(make, times)
    except EhaError as error:
        return row | {"why": str(error)}
    if largest == 0.0:
        return row | {"why": "no amplitude stays within the limits"}
    amplitude = largest * float(generator.choice(SHARES))
    stopped, rows = driven(case, limits, make(amplitude).voltage(times), generator)
    return row | {"amplitude": amplitude, "stopped": stopped, "shares": reached(rows, limits, case)}


def driven(case: Case, limits: Limits, voltages: Array, generator: np.random.Generator) -> tuple[str, Array]:
    """Why the watch stopped the motion, if it did; and the truth's rows, until some time after that."""
    truth = SteppedTruth(case.plant, case.effects, RATE, len(voltages))
    levels = case.noise * np.array([POSITION_NOISE, PRESSURE_NOISE, PRESSURE_NOISE])
    noise = levels * generator.standard_normal((len(voltages), 3))
    watch, stopped, rows, last = Watch(limits), "", [], len(voltages)
    for sample, voltage in enumerate(voltages.tolist()):
        position, _, *pressures = truth.sense()
        seen = np.array([position, *pressures]) + noise[sample]
        if not stopped:
            stopped = watch.trouble(sample / RATE, seen[0], {"pressure_a": seen[1], "pressure_b": seen[2]})
            last = sample + round(AFTER * RATE) if stopped else last
        rows.append(truth.hold(0.0 if stopped else voltage))
        if sample >= last:
            break
    return stopped, np.array(rows)


def reached(rows: Array, limits: Limits, case: Case) -> dict[str, float]:
    """The largest share of each limit, the end of the stroke among them, that the truth reached."""
    of = {name: rows[:, COLUMNS.index(name)] for name in ("position", "velocity", "pressure_a", "pressure_b")}
    farthest = float(np.max(np.abs(of["position"])))
    return {
        "position": farthest / limits.position,
        "speed": float(np.max(np.abs(of["velocity"]))) / limits.speed,
        "pressure": float(max(of["pressure_a"].max(), of["pressure_b"].max())) / limits.pressure,
        "stroke": farthest / case.plant["actuator_displacement"],
    }


def summed_up(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """How many motions went past a limit, by which, and how many the watch stopped."""
    moved = [row for row in rows if "shares" in row]
    yield f"{len(rows)} rigs, {len(moved)} moved; for the others no test stays within the limits"
    stopped = [row for row in moved if row["stopped"]]
    yield f"{len(stopped)} stopped by the watch"
    for name in moved[0]["shares"] if moved else ():
        past = [row for row in moved if row["shares"][name] > 1.0]
        most = max(row["shares"][name] for row in moved)
        caught = sum(bool(row["stopped"]) for row in past)
        yield f"{name}: {len(past)} past the limit, {caught} of them stopped; {most:.3f} of it at most"
    for row in moved:
        over = {name: round(share, 3) for name, share in row["shares"].items() if share > 1.0}
        if over:
            what = f"{row['kind']}, {' + '.join(row['concealed'])}"
            yield f"{row['number']}: {over}, {what}; {row['stopped'] or 'not stopped'}"


if __name__ == "__main__":
    try_rigs(try_rig, summed_up, __doc__, 1000)
