"""The loop on a simulated rig with the real diagnosis, and each way in which it ends."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from simulated_rig import SimulatedRig
from test_ending import diagnosis

from eha_core.diagnosis.experiment.limits import Limits
from eha_core.errors import ParameterError, RecordingError
from eha_core.investigation import Bounds, Investigation, first_test, investigate
from eha_core.investigation.loop import _ending
from eha_core.nominal import nominal_of
from eha_core.plant import composition_of

LIMITS = Limits(position=0.06, speed=0.3, pressure=25e6, voltage=1.0)
MODEL = nominal_of({})
COMMAND = "multisine:amplitude=0.06,lowest=0.3,highest=8,count=16,period=20,seed=5"
FIRST = first_test(COMMAND, 3.0, MODEL, LIMITS)


def test_a_rig_is_driven_diagnosed_and_its_friction_named() -> None:
    rig = SimulatedRig({"coulomb_friction.force": 30.0}, LIMITS)
    told: list[Investigation] = []
    state = investigate(rig, MODEL, LIMITS, FIRST, Bounds(), told.append, jobs=1)
    assert rig.names == ["test_1"] and told == [state]
    assert state.ending.kind == "resolved"
    (friction,) = state.found.effects
    force = friction.parameters["force"]
    assert friction.id == "coulomb_friction" and abs(force.value - 30.0) < 4.0 * force.std < 5.0
    (step,) = state.steps
    driven = step.recording.channels["voltage_command"].values[:1500]
    np.testing.assert_allclose(driven, FIRST.signal.voltage(np.arange(1500) * 2e-3), atol=1e-12)


def test_a_limit_in_sight_ends_it_without_an_error() -> None:
    rig = SimulatedRig({}, Limits(position=0.001, voltage=1.0))
    told: list[Investigation] = []
    state = investigate(rig, MODEL, LIMITS, FIRST, Bounds(), told.append)
    assert (state.steps, state.ending.kind, state.found) == ((), "stopped", None)
    assert state.ending.statement.endswith("the limit of 1.00 mm is in sight")
    assert told == [state]


def test_who_stops_the_rig_does_not_wait_for_the_end_of_a_diagnosis() -> None:
    rig = SimulatedRig({}, LIMITS)
    heard: list[str] = []

    def progress(message: str) -> None:
        heard.append(message)
        if "reading" in message:
            rig.stopped = "a key was pressed"

    state = investigate(rig, MODEL, LIMITS, FIRST, Bounds(), progress=progress)
    assert state.ending.kind == "stopped" and state.ending.statement == "a key was pressed"
    assert len(heard) == 2


def test_a_recording_that_cannot_be_right_is_an_error_that_the_page_shows() -> None:
    class Reversed(SimulatedRig):
        def run(self, motion, name):
            recording = super().run(motion, name)
            position = recording.channels["position"]
            flipped = replace(position, values=-position.values)
            return replace(recording, channels={**recording.channels, "position": flipped})

    told: list[Investigation] = []
    with pytest.raises(RecordingError):
        investigate(Reversed({}, LIMITS), MODEL, LIMITS, FIRST, Bounds(), told.append)
    assert [state.ending.kind for state in told] == ["failed"]


@pytest.mark.parametrize(
    ("bounds", "kind"),
    [(Bounds(2, 100.0), "limit_of_tests"), (Bounds(3, 9.0), "limit_of_time"), (Bounds(3, 100.0), None)],
)
def test_bounds_end_what_could_go_on(bounds: Bounds, kind: str | None) -> None:
    steps = [SimpleNamespace(diagnosis=diagnosis(rivals=rivals)) for rivals in (("b", "c"), ("b",))]
    ending = _ending(steps, bounds, 10.0)
    assert (ending and ending.kind) == kind


def test_an_actuator_that_no_voltage_drives_is_refused() -> None:
    rig = SimulatedRig({}, LIMITS)
    pump = nominal_of({}, composition=composition_of({"source": "switched_pump"}))
    with pytest.raises(ParameterError, match="switched_pump"):
        investigate(rig, pump, LIMITS, FIRST, Bounds())
    assert rig.names == []
