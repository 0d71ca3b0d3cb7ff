"""Friction that depends on a further recorded quantity is found as a function of it, and predicted in between."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from benches import TIME, recording, velocity
from measured import CURRENTS, needs_dampers, processed

from eha_core.errors import RecordingError
from eha_core.motion_given import Motion, diagnose_motion, find_law, fit_law, motion_of, predict
from eha_core.motion_given.schedule import levels_of, schedule_remarks

V = velocity(TIME)
VARYING = np.round(0.5 + 0.5 * np.sin(2.0 * np.pi * 0.13 * TIME), 4)


def bench(schedule: np.ndarray | float, force: np.ndarray, seed: int = 3) -> Motion:
    return motion_of(recording(force, seed=seed, schedule=np.broadcast_to(schedule, TIME.shape)))


def test_dry_friction_that_grows_in_proportion_has_two_levels() -> None:
    law = find_law([bench(VARYING, (100.0 + 400.0 * VARYING) * np.sign(V) + 900.0 * V)])
    assert law.ids == ("viscous_friction", "coulomb_friction")
    dry, viscous = law.values["coulomb_friction"], law.values["viscous_friction"]
    assert set(viscous) == {"damping"}
    assert dry["force at 0"].value == pytest.approx(100.0, rel=0.03)
    assert dry["force at 1"].value == pytest.approx(500.0, rel=0.03)
    assert viscous["damping"].value == pytest.approx(900.0, rel=0.02)


def test_a_saturating_course_has_more_levels_over_recordings_of_constant_schedule() -> None:
    def dry(s: float) -> float:
        return 100.0 + 900.0 * (1.0 - np.exp(-4.0 * s))

    steps = (0.0, 0.25, 0.5, 0.75, 1.0)
    law = find_law([bench(s, dry(s) * np.sign(V) + 900.0 * V, seed) for seed, s in enumerate(steps)])
    values = law.values["coulomb_friction"]
    for s in steps:
        assert values[f"force at {s:g}"].value == pytest.approx(dry(s), rel=0.02)
    assert set(law.values["viscous_friction"]) == {"damping"}


def test_a_schedule_that_changes_nothing_is_not_in_the_law() -> None:
    motions = [bench(VARYING, 150.0 * np.sign(V) + 900.0 * V)]
    law = find_law(motions)
    assert not any(term.levels for term in law.terms)
    assert schedule_remarks(motions, [], law.terms) == ["no coefficient was found to depend on schedule, from 0 to 1"]


def test_a_schedule_that_cannot_show_anything_is_reported() -> None:
    still, without = bench(0.5, 900.0 * V), replace(bench(0.5, 900.0 * V), schedule=None)
    assert "is 0.5 throughout" in schedule_remarks([still], [], ())[0]
    assert "1 of 2 recordings have it" in schedule_remarks([still, without], [], ())[0]
    assert schedule_remarks([without], [], ()) == []


def test_a_test_beyond_the_levels_is_reported_and_one_without_a_schedule_refused() -> None:
    force = (100.0 + 400.0 * VARYING) * np.sign(V)
    law = fit_law([bench(VARYING, force)], ["coulomb_friction"], ["coulomb_friction"])
    beyond = bench(1.5, 500.0 * np.sign(V))
    assert "beyond 0 to 1" in schedule_remarks([bench(VARYING, force)], [beyond], law.terms)[0]
    with pytest.raises(RecordingError, match="the law depends on schedule"):
        predict(law, replace(beyond, schedule=None))


def test_many_values_are_a_few_levels_with_both_ends() -> None:
    assert levels_of(np.array([1.0, 0.0, 1.0, 0.5]), 5) == (0.0, 0.5, 1.0)
    assert levels_of(np.linspace(20.0, 60.0, 999), 2) == (20.0, 60.0)
    assert levels_of(np.linspace(20.0, 60.0, 999), 5) == pytest.approx((20.0, 30.0, 40.0, 50.0, 60.0))


def test_the_statement_has_the_course() -> None:
    force = (100.0 + 400.0 * VARYING) * np.sign(V)
    found = diagnose_motion([recording(force, schedule=VARYING)])
    (effect,) = found.diagnosis.effects
    assert effect.statement.endswith("of dry friction opposes motion; force grows with schedule")
    assert " at 0 and " in effect.statement


@needs_dampers
@pytest.mark.parametrize(("unseen", "most"), [("0x25A", 0.13), ("0x5A", 0.06), ("0x75A", 0.08)])
def test_a_current_that_was_left_out_is_predicted(unseen: str, most: float) -> None:
    ids = ("viscous_friction", "bouc_wen_friction")
    others = [processed("10mm1Hz", current) for current in CURRENTS if current != unseen]
    law, motion = fit_law(others, ids, ids), processed("10mm1Hz", unseen)
    error = (predict(law, motion) - motion.force)[motion.used]
    assert np.sqrt(np.mean(error**2)) < most * np.std(motion.force)
    # one law without the current leaves half of the force
    assert fit_law(others, ids).share_left > 0.4
    assert law.share_left < 0.05


@needs_dampers
def test_one_law_holds_for_five_currents_and_dry_friction_grows() -> None:
    motions = [processed("10mm1Hz", current) for current in CURRENTS]
    law = fit_law(motions, ("viscous_friction", "bouc_wen_friction"), ("viscous_friction", "bouc_wen_friction"))
    forces = [law.values["bouc_wen_friction"][f"force at {s:g}"] for s in CURRENTS.values()]
    steps = [(b.value - a.value) / np.hypot(a.std, b.std) for a, b in zip(forces[:-1], forces[1:], strict=True)]
    assert min(steps) > 3.0
    assert law.share_left < 0.05
