"""How far a twin is from a false alarm: drawn rigs that are as modelled, followed for some minutes each.

    python -m tools.twin_trials --rigs 100 --seed S --out FILE [--first K] [--jobs 2]

Each rig is one of the exam's, its commands multisines within the default limits, its noise 1, 3 or 10 times the
usual. A line of FILE is one rig: its alarms, and the most evidence of a departure that any equation ever had.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from eha_core.detectability.design import kinds
from eha_core.detectability.margins import Margins
from eha_core.diagnosis.experiment.limits import limits_of
from eha_core.nominal import nominal_of
from eha_core.recording.simulated import Experiment, Simulated, simulate
from eha_core.twin import Comparison, Settings, Twin
from eha_core.twin.samples import nanoseconds
from eha_exam.drawing import draw_case
from tools.trial_rows import try_rigs

PIECES, SECONDS = 18, 20.0
"""Motions of each rig, and how long one takes. Each begins at mid-stroke: in open loop a piston drifts to an end."""

RATE = 500.0
"""Hz of all messages."""

LATE = 50_000
"""ns after a sample at which the command that answers it is published."""

PAUSE = 1.0
"""s between two motions, in which no message comes."""


def try_rig(number: int, seed: int) -> dict[str, Any]:
    """One rig: the windows compared, the alarms, and the most evidence of a departure [natural logarithm]."""
    case = draw_case("null", number, seed)
    generator = np.random.default_rng([seed, number])
    model, times = nominal_of(dict(case.nominal)), np.arange(round(SECONDS * RATE)) / RATE
    row: dict[str, Any] = {"number": number, "noise": case.noise}
    makes = kinds()["multisine"]
    largest = [Margins.of(model, limits_of(model.values)).largest_amplitude(make, times) for make in makes]
    twin = Twin(case.nominal, settings=Settings(command_limit=limits_of(model.values).voltage))
    windows, alarms, alarmed, most = 0, 0, False, -np.inf
    for piece in range(PIECES):
        kind = int(generator.integers(len(makes)))
        amplitude = largest[kind] * float(generator.uniform(0.1, 1.0))
        signal = makes[kind](amplitude)
        signal = replace(signal, parameters={**signal.parameters, "seed": int(generator.integers(1, 10**6))})
        experiment = Experiment(
            times, signal.voltage(times), SECONDS, parameters=dict(case.nominal), noise=case.noise,
            seed=int(generator.integers(10**6)),
        )  # fmt: skip
        for compared in _followed(twin, simulate(experiment), nanoseconds(piece * (SECONDS + PAUSE))):
            windows += 1
            alarms += bool(compared.departs) and not alarmed
            alarmed, most = bool(compared.departs), max(most, twin.evidence[0])
    return row | {"windows": windows, "alarms": alarms, "evidence": most, "needed": twin.evidence[1]}


def _followed(twin: Twin, record: Simulated, begin: int) -> Iterator[Comparison]:
    """What the twin says of a motion's messages, which begin at a stamp [ns]."""
    commands = dict(zip(record.commands[0].tolist(), record.commands[1].tolist(), strict=True))
    columns = [record.column(f"measured_{name}").tolist() for name in ("position", "pressure_a", "pressure_b")]
    for stamp, position, pressure_a, pressure_b in zip(record.stamps.tolist(), *columns, strict=True):
        twin.position(begin + stamp, position, begin + stamp)
        twin.pressure("a", begin + stamp, pressure_a)
        twin.pressure("b", begin + stamp, pressure_b)
        if stamp in commands:
            twin.command(begin + stamp + LATE, commands[stamp])
        compared = twin.compare()
        if compared is not None:
            yield compared


def summed_up(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """The time followed, the alarms, and the most evidence."""
    hours = sum(row["windows"] for row in rows) * Settings().window / 3600.0
    yield f"{len(rows)} rigs followed for {hours:.1f} h, {sum(row['alarms'] for row in rows)} alarms"
    for noise in sorted({row["noise"] for row in rows}):
        some = [row for row in rows if row["noise"] == noise]
        most, needed = max(row["evidence"] for row in some), some[0]["needed"]
        yield f"noise {noise:g}x, {len(some)} rigs: evidence of {most:.2f} at most, where an alarm needs {needed:.2f}"


if __name__ == "__main__":
    try_rigs(try_rig, summed_up, __doc__, 100)
