"""Log files as measurement systems write them give the numbers that were written."""

from __future__ import annotations

import sys
import tracemalloc
from pathlib import Path

import h5py
import numpy as np
import pytest
from example_run import CHANNELS, COUNT, PERIOD, TIME, TOPICS, written
from scipy.io import savemat

from eha_core.errors import RecordingError
from eha_core.recording import read_recording
from eha_core.tables import read_table


@pytest.mark.parametrize("kind", list(TOPICS))
def test_every_kind_gives_the_run_in_si_units(tmp_path: Path, kind: str) -> None:
    recording = read_recording(*written(tmp_path, kind))
    assert set(recording.channels) == set(CHANNELS)
    for name, expected in CHANNELS.items():
        channel = recording.channels[name]
        np.testing.assert_allclose(channel.values, expected, rtol=2e-7, atol=1e-9 if name != "pressure_a" else 1.0)
        np.testing.assert_allclose(channel.time, TIME, atol=5e-7)
    assert recording.damaged is None


def test_a_date_is_the_instant_that_it_names(tmp_path: Path) -> None:
    recording = read_recording(*written(tmp_path, "dates"))
    assert recording.start_stamp == 1_726_000_000_000_000_000  # 2024-09-10 20:26:40 UTC


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        ("2024-09-10T20:26:40Z", 1_726_000_000.0),
        ("2024-09-10 20:26:40.000001234", 1_726_000_000.000001234),
        ("10.09.2024 20:26:40,5", 1_726_000_000.5),
        ("2024/09/10 16:26:40-04:00", 1_726_000_000.0),
        ("20:26:40.25", 73600.25),
        ("8:26:40", 30400.0),
    ],
)
def test_dates_and_times_of_day_in_the_usual_forms(tmp_path: Path, cell: str, expected: float) -> None:
    path = tmp_path / "run.csv"
    path.write_text(f"time;position\n{cell};0,1\n{cell};0,2\n")
    table = read_table(path)
    assert table.units["time"] == "ns"
    assert (
        table.columns["time"].tolist() == [round(expected * 1e9)] * 2
        or abs(table.columns["time"][0] * 1e-9 - expected) < 1e-6
    )
    np.testing.assert_array_equal(table.columns["position"], [0.1, 0.2])


@pytest.mark.parametrize(("unit", "factor"), [("ms", 10**3), ("us", 10**6), ("ns", 10**9)])
def test_counts_since_1970_are_recognised_and_said(tmp_path: Path, unit: str, factor: int) -> None:
    path = tmp_path / "run.csv"
    start = 1_726_000_000 * factor
    stamps = [start + round(k * PERIOD * factor) for k in range(COUNT)]
    path.write_text("time,position\n" + "".join(f"{stamp},{k * 1e-5}\n" for k, stamp in enumerate(stamps)))
    recording = read_recording(path)
    np.testing.assert_allclose(recording.channels["position"].time, TIME, atol=5e-7)
    assert any(f"was taken as {unit} since 1970" in remark for remark in recording.remarks)


def test_a_second_segment_or_group_is_left_out_and_said(tmp_path: Path) -> None:
    for kind in ("labview", "control_desk"):
        path, topics = written(tmp_path, kind)
        text = path.read_text()
        lines = text.splitlines()
        again = lines[12:] if kind == "labview" else [lines[0], *lines[2:]]
        path.write_text(text + "\n" + "\n".join(again) + "\n")
        recording = read_recording(path, topics)
        assert len(recording.channels["position"].values) == COUNT
        assert any("were left out" in remark for remark in recording.remarks)


def test_structures_of_simulink_are_columns_by_their_labels(tmp_path: Path) -> None:
    path = tmp_path / "scope.mat"
    kind = [("label", object), ("values", object)]
    signals = np.array([("u", TIME * 2), ("x", TIME * 3)], dtype=kind)
    savemat(path, {"out": {"time": TIME, "signals": signals}, "matrix": np.stack([TIME, TIME * 5])})
    columns = read_table(path).columns
    np.testing.assert_array_equal(columns["out.time"], TIME)
    np.testing.assert_array_equal(columns["out.signals.x"], TIME * 3)
    np.testing.assert_array_equal(columns["matrix[1]"], TIME * 5)


def test_structures_of_version_73_are_columns_by_their_labels(tmp_path: Path) -> None:
    path = tmp_path / "scope.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        refs = file.create_group("#refs#")
        group = file.create_group("out/signals")
        texts = {"u": [117], "x": [120]}
        for name, text in texts.items():
            made = refs.create_dataset(f"{name}l", data=np.array([text], dtype=np.uint16))
            made.attrs["MATLAB_class"] = np.bytes_("char")
            refs.create_dataset(f"{name}v", data=TIME.reshape(1, -1) * (2 if name == "u" else 3))
        for field, ending in (("label", "l"), ("values", "v")):
            links = np.array([[refs[f"{name}{ending}"].ref] for name in texts], dtype=h5py.ref_dtype)
            group.create_dataset(field, data=links, dtype=h5py.ref_dtype)
        file["out"].create_dataset("time", data=TIME.reshape(1, -1))
    columns = read_table(path).columns
    np.testing.assert_array_equal(columns["out.time"], TIME)
    np.testing.assert_array_equal(columns["out.signals.x"], TIME * 3)


def test_columns_of_another_length_than_the_time_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    savemat(path, {"time": TIME, "position": TIME[:100]})
    with pytest.raises(RecordingError, match="has 100 values and the time 'time' has 400"):
        read_recording(path)


@pytest.mark.parametrize("kind", ["mat_73", "parquet"])
def test_a_library_that_is_missing_is_named_with_what_installs_it(
    tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = {"mat_73": "h5py", "parquet": "pyarrow"}[kind]
    path, topics = written(tmp_path, kind)
    for module in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(RecordingError, match=f"are read by {package}; install it: pip install {package}"):
        read_recording(path, topics)


@pytest.mark.parametrize("kind", list(TOPICS))
@pytest.mark.parametrize("seed", range(6))
def test_a_damaged_file_gives_what_it_can_or_one_line(tmp_path: Path, kind: str, seed: int) -> None:
    path, topics = written(tmp_path, kind)
    generator = np.random.default_rng(seed)
    data = bytearray(path.read_bytes())
    for place in generator.integers(len(data), size=20):
        data[place] = generator.integers(256)
    path.write_bytes(bytes(data[: len(data) // 2] if seed == 5 else data))
    try:
        read_recording(path, topics)
    except RecordingError as error:
        assert "\n" not in str(error)


def test_a_link_to_another_file_of_the_machine_is_not_followed(tmp_path: Path) -> None:
    secret = tmp_path / "secret.h5"
    with h5py.File(secret, "w") as file:
        file["key"] = np.arange(100.0)
    (tmp_path / "raw.bin").write_bytes(np.arange(100.0).tobytes())
    path = tmp_path / "run.mat"
    with h5py.File(path, "w") as file:
        file["time"] = TIME
        file["stolen"] = h5py.ExternalLink(str(secret), "key")
        file.create_dataset("raw", (100,), "f8", external=[(str(tmp_path / "raw.bin"), 0, 800)])
    assert list(read_table(path).columns) == ["time"]


def test_a_variable_that_unpacks_without_end_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bomb.mat"
    savemat(path, {"time": np.zeros(8_000_000)}, do_compression=True)
    assert path.stat().st_size < 100_000
    with pytest.raises(RecordingError, match="unpacks to more than a file of its size may; keep fewer"):
        read_table(path)


@pytest.mark.parametrize("seed", range(40))
def test_a_mat_file_whose_sizes_lie_costs_no_memory(tmp_path: Path, seed: int) -> None:
    path = tmp_path / "lies.mat"
    cells = np.array([TIME, {"a": TIME, "b": np.array([TIME, "text"], dtype=object)}], dtype=object)
    savemat(path, {"time": TIME, "position": TIME, "cells": cells})
    data, generator = bytearray(path.read_bytes()), np.random.default_rng(seed)
    sizes = [
        place for place in range(128, len(data), 4) if 0 < int.from_bytes(data[place : place + 4], "little") < 5000
    ]
    for place in generator.choice(sizes, 2):
        data[place : place + 4] = int(generator.integers(2**31)).to_bytes(4, "little")
    path.write_bytes(bytes(data))
    tracemalloc.start()
    try:
        read_recording(path)
    except RecordingError as error:
        assert "\n" not in str(error)
    finally:
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < 20e6


def test_a_line_without_end_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from eha_core.tables import text_table

    monkeypatch.setattr(text_table, "LONGEST_LINE", 1000)
    path = tmp_path / "run.csv"
    path.write_text("time,position\n0,1\n1,2\n" + "1" * 10_000)
    with pytest.raises(RecordingError, match="a line of more than 1000 characters"):
        read_table(path)


@pytest.mark.parametrize("step", ["1e999", "-0,001", "0,0", "nan", "1e200"])
def test_a_labview_step_that_is_none_gives_no_times(tmp_path: Path, step: str) -> None:
    path, topics = written(tmp_path, "labview")
    path.write_text(path.read_text().replace("0,001000", step))
    with pytest.raises(RecordingError, match="column 'X_Value' holds no numbers"):
        read_recording(path, topics)


def test_a_variable_that_is_an_object_is_left_out_and_said(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    savemat(path, {"time": TIME, "position": TIME, "handle": np.arange(3.0)})
    data = bytearray(path.read_bytes())
    # The class of the last variable, in its flags: a function handle.
    flags = data.rindex(b"\x06\x00\x00\x00\x08\x00\x00\x00") + 8
    data[flags] = 16
    path.write_bytes(bytes(data))
    table = read_table(path)
    assert list(table.columns) == ["time", "position"]
    assert table.remarks == ("1 variables that are objects, tables, functions or sparse were left out",)


def test_a_text_without_dimensions_is_refused_before_it_is_read(tmp_path: Path) -> None:
    # SciPy 1.15.3 ends the process with a segmentation fault at this one.
    path = tmp_path / "run.mat"
    savemat(path, {"time": TIME, "note": "x"})
    data = path.read_bytes()
    flags_of_text_and_shape = b"\x04\x00\x00\x00\x00\x00\x00\x00\x05\x00\x00\x00"
    assert data.count(flags_of_text_and_shape) == 1
    place = data.index(flags_of_text_and_shape) + len(flags_of_text_and_shape)
    path.write_bytes(data[:place] + b"\0" + data[place + 1 :])
    with pytest.raises(RecordingError, match="a matrix has no shape"):
        read_table(path)
