"""The loop: run a test, diagnose all tests together, and choose the next by what is left open."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from eha_core.control.linear_model import velocity_gain
from eha_core.diagnosis import diagnose_together
from eha_core.diagnosis.experiment.limits import REACHED, Limits
from eha_core.diagnosis.result import Diagnosis
from eha_core.errors import EhaError
from eha_core.investigation.ending import Ending, settled
from eha_core.investigation.motion import MotionStopped, Rig, from_mid_stroke
from eha_core.investigation.voltage_test import VoltageTest
from eha_core.nominal import NominalModel
from eha_core.plant.plant_file import require_voltage
from eha_core.plausibility import admit
from eha_core.recording import Recording

MARGIN = 0.8
"""Share of each limit that a proposed test may reach on the rivals' models: the rest is for what these do not know, and
for the watch, which stops the motion ahead of a limit (assumed)."""


@dataclass(frozen=True)
class Bounds:
    """After how many tests, and after how many seconds of wall-clock time, no further test begins."""

    tests: int = 5
    seconds: float = 3600.0


@dataclass(frozen=True)
class Step:
    """One test: what was recorded of it, what all tests so far say together, and how long that took [s]."""

    test: VoltageTest
    recording: Recording
    diagnosis: Diagnosis
    seconds: float


@dataclass(frozen=True)
class Investigation:
    """Every step, and how it ended; `ending` is None while it goes on."""

    limits: Limits
    steps: tuple[Step, ...] = ()
    ending: Ending | None = None

    @property
    def found(self) -> Diagnosis | None:
        """What all tests together say; None before the first."""
        return self.steps[-1].diagnosis if self.steps else None


def investigate(
    rig: Rig,
    model: NominalModel,
    limits: Limits,
    first: VoltageTest,
    bounds: Bounds,
    told: Callable[[Investigation], None] = lambda _: None,
    progress: Callable[[str], None] = lambda _: None,
    jobs: int = 2,
) -> Investigation:
    """Drive a rig with test after test until one set of effects remains, no test would tell more, or a bound is met.

    Args:
        rig: what moves and records.
        model: the nominal model, whose actuator a voltage drives.
        limits: what the rig bears.
        first: the first test.
        bounds: how many tests, and how long.
        told: receives the investigation after each step and at its end.
        progress: receives what is being done.
        jobs: threads of a diagnosis.

    Raises:
        EhaError: the actuator is driven by no voltage, or a recording cannot be right. A motion that was stopped is no
            error but an ending.
    """
    require_voltage(model.composition)
    began = time.monotonic()
    state = Investigation(limits)
    test = first
    try:
        while state.ending is None:
            state = replace(state, steps=(*state.steps, _step(rig, model, limits, test, state.steps, progress, jobs)))
            state = replace(state, ending=_ending(state.steps, bounds, time.monotonic() - began))
            told(state)
            proposed = state.steps[-1].diagnosis.next_experiment
            test = VoltageTest.proposed(proposed) if state.ending is None and proposed else test
    except MotionStopped as stopped:
        state = replace(state, ending=Ending("stopped", str(stopped)))
        told(state)
    except EhaError as error:
        told(replace(state, ending=Ending("failed", str(error))))
        raise
    return state


def _step(
    rig: Rig, model: NominalModel, limits: Limits, test: VoltageTest, before: Sequence[Step],
    progress: Callable[[str], None], jobs: int,
) -> Step:  # fmt: skip
    """Run a test from mid stroke, and diagnose it together with those before."""
    began, number = time.monotonic(), len(before) + 1

    def say(message: str) -> None:
        rig.check()  # a diagnosis takes a minute, and who stops the rig does not want to wait for its end
        progress(f"test {number}: {message}")

    say(f"a {test.signal.signal} of voltage ({test.signal.settings()}) for {test.duration:g} s")
    recorded = rig.run(from_mid_stroke(test, velocity_gain(model.values), limits), f"test_{number}")
    recording = admit(recorded, model.values, composition=model.composition)
    recordings = [*(step.recording for step in before), recording]
    planned = replace(limits, **{name: MARGIN * getattr(limits, name) for name in REACHED if name != "voltage"})
    found = diagnose_together(recordings, model, say, jobs, limits=planned)
    return Step(test, recording, found, time.monotonic() - began)


def _ending(steps: Sequence[Step], bounds: Bounds, elapsed: float) -> Ending | None:
    """Why the last step was the last; None where another test is to be made."""
    ending = settled([step.diagnosis for step in steps])
    if ending is None and len(steps) >= bounds.tests:
        ending = Ending("limit_of_tests", f"{len(steps)} tests were made; {steps[-1].diagnosis.summary}")
    if ending is None and elapsed >= bounds.seconds:
        ending = Ending("limit_of_time", f"{elapsed:.0f} s have passed; {steps[-1].diagnosis.summary}")
    return ending
