"""What is done about a departure in the second process, from the alarm to the end."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from beside_rig import comparisons, rig

from eha_core.errors import EhaError
from eha_core.recording import read_recording
from eha_core.twin import Settings, Twin
from eha_core.twin.explanation import Explanation
from eha_core.twin.follow_up import FollowUp, News
from eha_core.twin.snapshot import Snapshots

LEAK = [(2.5, "internal_leakage", 6.5e-11)]
Make = Callable[..., FollowUp]


@pytest.fixture
def make() -> Iterator[Make]:
    made: list[FollowUp] = []

    def follow_up(is_naming: bool, folder: str, after: float = 1.0) -> FollowUp:
        made.append(FollowUp(is_naming, folder, Snapshots(2.0, after)))
        return made[-1]

    yield follow_up
    for one in made:
        one.close()


def fed(follow_up: FollowUp, seconds: float, changes: list[tuple[float, str, float]] = LEAK) -> None:
    twin = Twin(settings=Settings(kept=2.0))
    for _, comparison in comparisons(rig(seconds, changes=changes), twin):
        began = time.monotonic()
        follow_up.take(comparison, twin.kept, twin.parameters)
        assert time.monotonic() - began < 0.1  # a naming takes more


def collected(follow_up: FollowUp, kinds: set[type]) -> list[News]:
    """What comes until there was one of each kind, within two minutes: on a new machine all is compiled first."""
    news, deadline = list[News](), time.monotonic() + 120.0
    while not kinds <= {kind for one in news for kind in type(one).__mro__} and time.monotonic() < deadline:
        news += follow_up.collect()
        time.sleep(0.01)
    return news


def test_a_leak_is_named_and_recorded(make: Make, tmp_path: Path) -> None:
    follow_up = make(True, str(tmp_path))
    fed(follow_up, 5.4)
    collected(follow_up, {Explanation, Path})
    assert follow_up.explanation is not None and follow_up.explanation.cause is not None
    assert follow_up.explanation.cause.name == "internal_leakage"
    assert follow_up.snapshot is not None and follow_up.snapshot.parent == tmp_path
    assert read_recording(follow_up.snapshot).duration == pytest.approx(3.0, abs=0.01)


def test_a_departure_that_ended_has_no_cause_any_more(make: Make) -> None:
    follow_up = make(True, "")
    fed(follow_up, 9.0, [*LEAK, (4.0, "internal_leakage", 1e-12)])
    (news, *_) = collected(follow_up, {Explanation})
    assert isinstance(news, Explanation) and follow_up.explanation is None and follow_up.snapshot is None


def test_the_end_writes_the_snapshot_under_way(make: Make, tmp_path: Path) -> None:
    follow_up = make(False, str(tmp_path), after=60.0)
    fed(follow_up, 5.4)
    (path,) = follow_up.close()
    assert isinstance(path, Path) and read_recording(path).duration == pytest.approx(4.0, abs=0.01)


def test_what_the_second_process_has_not_written_at_the_end_is_written(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("eha_core.twin.follow_up.PATIENCE", 0.0)  # it is still preparing
    follow_up = make(False, str(tmp_path))
    fed(follow_up, 5.4)
    (path,) = follow_up.close()
    assert isinstance(path, Path) and read_recording(path).duration == pytest.approx(3.0, abs=0.01)


def test_a_folder_that_has_gone_is_an_error_in_one_line(make: Make, tmp_path: Path) -> None:
    folder = tmp_path / "snapshots"
    follow_up = make(False, str(folder))
    folder.rmdir()
    folder.touch()
    fed(follow_up, 5.4)
    (error,) = collected(follow_up, {EhaError})
    assert str(error).startswith("no snapshot: ") and "snapshots" in str(error) and "\n" not in str(error)


def test_a_folder_that_cannot_be_made_is_refused_at_the_start(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(EhaError, match="file/folder: cannot be made"):
        FollowUp(True, str(tmp_path / "file" / "folder"), Snapshots(2.0, 1.0))


def test_without_either_no_process_is_started(make: Make) -> None:
    follow_up = make(False, "")
    fed(follow_up, 5.4)
    assert follow_up.collect() == [] and follow_up.close() == []
