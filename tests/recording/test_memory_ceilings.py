"""Files that unpack to more than a machine has: refused before they are read, by what reading takes at its peak."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import h5py
import numpy as np
import pyarrow
import pytest
from mcap.writer import Writer
from pyarrow import parquet

from eha_core.errors import RecordingError
from eha_core.recording.inspection import MOST_TOPICS, inspect_file
from eha_core.tables.table import COPIES, MOST_CELLS, MOST_MEMORY, refuse_large

ROWS = 2**27
START = 1_700_000_000_000_000_000


def test_a_mat_file_of_zeros_is_refused_before_they_are_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "bomb.mat"
    with h5py.File(path, "w") as file:
        file.create_dataset("position", (ROWS,), "f8", chunks=(2**20,), compression="gzip")
        file["time"] = np.arange(2500) * 1e-3
    assert path.stat().st_size < 100_000
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match=r"bomb\.mat: takes 6\.4 GB to read, more than 1\.6 GB; keep fewer"):
            inspect_file(path)
        assert tracemalloc.get_traced_memory()[1] < 2**25
    finally:
        tracemalloc.stop()


def test_a_parquet_file_of_one_value_is_refused_before_it_is_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "bomb.parquet"
    rows = MOST_MEMORY // 8 // (1 + COPIES) + 1
    parquet.write_table(pyarrow.table({"position": np.zeros(rows, np.int8)}), path)
    before = pyarrow.total_allocated_bytes()
    with pytest.raises(RecordingError, match=r"bomb\.parquet: takes 1\.6 GB to read, more than 1\.6 GB; keep fewer"):
        inspect_file(path)
    assert pyarrow.total_allocated_bytes() - before < 2**20


def test_a_parquet_file_is_never_twice_in_memory(tmp_path: Path) -> None:
    path, rows, count = tmp_path / "run.parquet", 100_000, 40
    parquet.write_table(pyarrow.table({f"c{k}": np.arange(rows) * (k + 0.5) for k in range(count)}), path)
    former, counted = pyarrow.default_memory_pool(), pyarrow.proxy_memory_pool(pyarrow.system_memory_pool())
    pyarrow.set_memory_pool(counted)
    try:
        fields = inspect_file(path).fields
    finally:
        pyarrow.set_memory_pool(former)
    assert [field.high for field in fields] == [(rows - 1) * (k + 0.5) for k in range(count)]
    assert counted.max_memory() < 0.6 * 8 * rows * count  # what the read columns keep of it apart


def test_three_hours_of_ten_channels_at_1_khz_still_fit() -> None:
    rows = 3 * 3600 * 1000
    refuse_large("rig", 10 * rows, 10, rows)
    with pytest.raises(RecordingError, match="rig: has more than"):
        refuse_large("rig", MOST_CELLS + 1, 1000, 2**17)


def test_a_recording_of_all_the_topics_that_mcap_can_number_is_listed_in_part(tmp_path: Path) -> None:
    path, count = tmp_path / "many.mcap", 2**16 - 1
    writer = Writer(str(path))
    writer.start("ros2")
    schema = writer.register_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data")
    channels = [writer.register_channel(f"/t{k}", "cdr", schema) for k in range(count)]
    for k, channel in enumerate(channels):
        writer.add_message(channel, START + k, b"\0\1\0\0" + bytes(8), START + k)
    writer.finish()
    found = inspect_file(path)
    assert [field.topic for field in found.fields] == [f"/t{k}" for k in range(MOST_TOPICS)]
    assert found.remarks == (f"{count - MOST_TOPICS} topics more are not listed; a topics file can name them",)
