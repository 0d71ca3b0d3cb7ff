"""A diagnosis of a stretch, moved into the time of its record."""

from __future__ import annotations

from pathlib import Path

from eha_core.diagnosis.result import Diagnosis, Explained, Location, NamedEffect, Pictures
from eha_core.long_record.in_its_time import in_time_of_record
from eha_core.recording import Recording

STRETCH = Recording(Path("stretch.mcap"), {}, 7_000_000_000, 10.0, {}, (), None, ())


def of_stretch(*places: Location) -> Diagnosis:
    friction = NamedEffect(
        "coulomb_friction", "force", "", {}, 9.0, "the seals rub, from 2.5 s to 4 s only", (2.5, 4.0)
    )
    return Diagnosis(
        path="stretch.mcap", duration=10.0, channels=(), not_examined=(), remarks=(), damaged=None,
        verdict="missing_physics", summary="Physics is missing: the seals rub, from 2.5 s to 4 s only.",
        location=places, parameters=(), effects=(friction,), alternatives=(), unknown=None, training={}, held_out={},
        next_experiment=None, rivals=(), whiteness={}, fitted_values={}, pictures=Pictures({}, {}, {}, {}, {}),
        start_stamp=7_000_000_000, explained=Explained(1.0, {}, True),
    )  # fmt: skip


def test_its_times_are_the_record_s_and_a_span_that_is_the_stretch_is_marked() -> None:
    places = (
        Location("force", 0.9, "", ((0.0, 10.0),)),
        Location("orifice", 0.5, "", ((2.5, 4.0),)),
        Location("chamber", 0.3, "", ((0.0, 3.0), (4.0, 10.0))),
    )
    moved = in_time_of_record(of_stretch(*places), [(Path("hour.mcap"), 3600.0, [STRETCH], [(600.0, 610.0)])])
    assert (moved.path, moved.duration) == ("hour.mcap", 3600.0)
    assert [place.when for place in moved.location] == [
        ((600.0, 610.0),), ((602.5, 604.0),), ((600.0, 603.0), (604.0, 610.0)),
    ]  # fmt: skip
    assert [place.all_of_stretch for place in moved.location] == [True, False, False]
    assert moved.effects[0].active == (602.5, 604.0)
    assert "from 602.5 s to 604 s only" in moved.summary


def test_a_recording_that_is_no_stretch_keeps_its_times() -> None:
    alone = of_stretch(Location("force", 0.9, "", ((0.0, 10.0),)))
    assert in_time_of_record(alone, [(Path("hour.mcap"), 3600.0, [], [])]) == alone
