"""Further recordings of a case's rig: with other loads, or driven with the test that a diagnosis prescribed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from eha_exam.case import POSITION_NOISE, Array, Arrays, Case
from eha_exam.drawing import LOAD
from eha_exam.errors import ExamError
from eha_exam.measuring import measure, simulate_case
from eha_exam.reference_signals import voltage_of
from eha_exam.truth import simulate_truth

DURATION = 10.0
LONGEST = 60.0
"""s; a prescribed test is run for the first unless it says its own `duration`, and for no more than the second."""


def prescribed_voltage(reference: Mapping[str, Any], time: Array) -> Array:
    """The voltage [V] of a prescribed test, given as the reference generator's parameters.

    ExamError when it is no voltage, or no signal that the exam knows.
    """
    if reference.get("mode", "voltage") != "voltage":
        raise ExamError(f"the prescribed test is a reference of {reference['mode']}, and the exam drives voltages")
    return voltage_of(reference, time)


def with_other_loads(case: Case) -> list[Arrays]:
    """What the sensors of a case's rig record of another test for each of its `loads`."""
    recordings = []
    for number, load in enumerate(case.loads, 1):
        effects = tuple((name, {**values, "force": load} if name == LOAD else values) for name, values in case.effects)
        again = replace(case, seed=case.seed + number, effects=effects)
        recordings.append(measure(again, simulate_case(again)))
    return recordings


def second_recording(case: Case, prescribed: Mapping[str, Any]) -> Arrays:
    """What the sensors of a case's rig record of the prescribed test: its channels, and those it is to `record`."""
    more = [str(name) for name in prescribed.get("record") or ()]
    unknown = [name for name in more if name not in Case.channels]
    if unknown:
        raise ExamError(f"the prescribed test wants {', '.join(unknown)} recorded, which this rig has no sensor for")
    channels = tuple(name for name in Case.channels if name in (*case.channels, *more))
    if not prescribed.get("reference"):
        raise ExamError("the prescribed test has no reference; give the reference generator's parameters")
    duration = float(prescribed.get("duration") or DURATION)
    if not 0.0 < duration <= LONGEST:
        raise ExamError(f"the prescribed test lasts {duration:g} s, and the exam runs at most {LONGEST:g} s")
    again = replace(case, seed=case.seed + 1, duration=duration, windows={}, channels=channels)
    time = np.arange(round(duration * case.rate) + 1) / case.rate
    voltage = prescribed_voltage(prescribed["reference"], time)
    truth = simulate_truth(case.plant, case.effects, voltage, duration, case.rate)
    generator = np.random.default_rng([case.seed, 4])
    noise = case.noise * POSITION_NOISE * generator.standard_normal(len(time))
    return measure(again, truth | {"position_noise": noise})
