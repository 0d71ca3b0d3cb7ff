"""The loop: run a test, diagnose all tests together, and choose the next one by the remaining rivals."""

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
"""Share of each limit that a proposed test may reach on the rivals' models: the rest is for their errors, and for the
watch, which stops the motion before a limit (assumed)."""


@dataclass(frozen=True)
class Bounds:
    """Number of tests, and seconds of wall-clock time, after which no further test begins."""

    tests: int = 5
    seconds: float = 3600.0


@dataclass(frozen=True)
class Step:
    """One test: its recording, the joint diagnosis of all tests so far, and how long both took [s]."""

    test: VoltageTest
    recording: Recording
    diagnosis: Diagnosis
    seconds: float


@dataclass(frozen=True)
class Investigation:
    """Every step, and the ending; `ending` is None while it runs."""

    limits: Limits
    steps: tuple[Step, ...] = ()
    ending: Ending | None = None

    @property
    def found(self) -> Diagnosis | None:
        """The diagnosis of all tests together; None before the first."""
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
    """Drive a rig with tests until one set of effects remains, no test would distinguish more, or a bound is reached.

    Args:
        rig: moves and records.
        model: the nominal model, whose actuator a voltage drives.
        limits: those of the rig.
        first: the first test.
        bounds: how many tests, and how long.
        told: receives the investigation after each step and at its end.
        progress: receives a message for each step of the work.
        jobs: threads of a diagnosis.

    Raises:
        EhaError: no voltage drives the actuator, or a recording is implausible. A motion that was stopped is not an
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
    """Run a test from mid-stroke, and diagnose it together with those before."""
    began, number = time.monotonic(), len(before) + 1

    def say(message: str) -> None:
        rig.check()  # a diagnosis takes a minute: a stop must not wait for its end
        progress(f"test {number}: {message}")

    say(f"a {test.signal.signal} of voltage ({test.signal.settings()}) for {test.duration:g} s")
    recorded = rig.run(from_mid_stroke(test, velocity_gain(model.values), limits), f"test_{number}")
    recording = admit(recorded, model.values, composition=model.composition)
    recordings = [*(step.recording for step in before), recording]
    planned = replace(limits, **{name: MARGIN * getattr(limits, name) for name in REACHED if name != "voltage"})
    found = diagnose_together(recordings, model, say, jobs, limits=planned)
    return Step(test, recording, found, time.monotonic() - began)


def _ending(steps: Sequence[Step], bounds: Bounds, elapsed: float) -> Ending | None:
    """Why the investigation ends after the last step; None where another test follows."""
    ending = settled([step.diagnosis for step in steps])
    if ending is None and len(steps) >= bounds.tests:
        ending = Ending("limit_of_tests", f"{len(steps)} tests were made; {steps[-1].diagnosis.summary}")
    if ending is None and elapsed >= bounds.seconds:
        ending = Ending("limit_of_time", f"{elapsed:.0f} s have passed; {steps[-1].diagnosis.summary}")
    return ending
