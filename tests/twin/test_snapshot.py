"""The seconds about an alarm, as a recording that a diagnosis reads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from beside_rig import NANOSECONDS, PERIOD, comparisons, rig

from eha_core.diagnosis.pipeline import diagnose
from eha_core.errors import RecordingError
from eha_core.nominal import nominal_of
from eha_core.recording import read_recording
from eha_core.recording.simulated import Simulated
from eha_core.twin import Settings, Twin
from eha_core.twin.excerpt import Excerpt
from eha_core.twin.samples import nanoseconds
from eha_core.twin.snapshot import Snapshots, write_snapshot

LEAK = [(2.5, "internal_leakage", 6.5e-11)]


def snapshots(record: Simulated, before: float, after: float, **options: tuple[float, float]) -> list[Excerpt]:
    """Those that are complete, the one under way at the end too."""
    twin, taken = Twin(settings=Settings(kept=before)), Snapshots(before, after)
    found = [taken.take(comparison, twin.kept) for _, comparison in comparisons(record, twin, **options)]
    return [one for one in (*found, taken.finish()) if one is not None]


def seconds(excerpt: Excerpt) -> tuple[float, float]:
    return excerpt.start / NANOSECONDS, excerpt.end / NANOSECONDS


def test_a_leak_is_diagnosed_from_the_snapshot_of_its_alarm(tmp_path: Path) -> None:
    record = rig(6.0, changes=LEAK)
    (excerpt,) = snapshots(record, 2.0, 2.0)
    path = write_snapshot(tmp_path / "new folder", excerpt, Twin().parameters)
    recording = read_recording(path)
    begin = round(excerpt.start / NANOSECONDS / PERIOD)
    position = recording.channels["position"].values
    assert np.array_equal(position, record.column("measured_position")[begin : begin + len(position)])
    assert recording.duration == pytest.approx(4.0, abs=0.01)
    diagnosis = diagnose(recording, nominal_of({}))
    (effect,) = diagnosis.effects
    assert effect.id == "leakage_onset"  # internal leakage that jumps
    leakage, time = effect.parameters["internal_leakage"], effect.parameters["time"]
    assert leakage.value == pytest.approx(6.5e-11, abs=3.0 * leakage.std)
    assert excerpt.start / NANOSECONDS + time.value == pytest.approx(2.5, abs=0.02)


def test_a_snapshot_lasts_from_before_the_alarm_until_after_it() -> None:
    (excerpt,) = snapshots(rig(8.0, changes=LEAK), 2.0, 1.5)
    assert seconds(excerpt) == pytest.approx((1.2, 4.7), abs=0.01)  # the alarm: the window that ends at 3.2 s
    (cut_short,) = snapshots(rig(5.4, changes=LEAK), 2.0, 60.0)
    assert seconds(cut_short) == pytest.approx((1.2, 5.2), abs=0.01)
    assert snapshots(rig(5.0), 2.0, 1.0) == []


def test_a_snapshot_ends_at_a_gap_and_the_next_alarm_has_its_own() -> None:
    changes = [*LEAK, (6.0, "internal_leakage", 1e-12), (9.5, "internal_leakage", 6.5e-11)]
    first, second = snapshots(rig(13.0, changes=changes), 1.0, 1.0)
    assert first.end < second.start
    gap = snapshots(rig(8.0, changes=LEAK), 2.0, 60.0, missing=(5.3, 5.9))
    assert seconds(gap[0])[1] == pytest.approx(5.2, abs=0.01)


def test_a_held_voltage_is_there_with_every_position(tmp_path: Path) -> None:
    samples = np.arange(0, nanoseconds(2.0), nanoseconds(0.002))
    voltage = np.array([0, nanoseconds(0.9995)]), np.array([0.1, -0.2])
    excerpt = Excerpt(0, nanoseconds(2.0), voltage, {"position": (samples, np.sin(3e-9 * samples))})
    written = read_recording(write_snapshot(tmp_path, excerpt, Twin().parameters)).channels["voltage_command"]
    assert len(written.time) == len(samples) + 1  # the change lies between two positions
    assert np.array_equal(written.values, np.where(written.time < 0.9995 - 1e-9, 0.1, -0.2))


def test_two_in_one_second_have_two_names_and_a_file_in_the_way_is_reported(tmp_path: Path) -> None:
    excerpt, parameters = snapshots(rig(5.4, changes=LEAK), 1.0, 1.0)[0], Twin().parameters
    assert len({write_snapshot(tmp_path, excerpt, parameters) for _ in range(3)}) == 3
    (tmp_path / "file").touch()
    with pytest.raises(RecordingError, match="file"):
        write_snapshot(tmp_path / "file", excerpt, parameters)
