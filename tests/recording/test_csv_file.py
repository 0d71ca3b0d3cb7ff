"""CSV files with a header row."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eha_core.errors import RecordingError
from eha_core.recording import read_recording


def csv_file(folder: Path, text: str) -> Path:
    path = folder / "run.csv"
    path.write_text(text)
    return path


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_columns_named_like_channels_are_read(tmp_path: Path, delimiter: str) -> None:
    rows = ["time,voltage_command,position,remark", "10.0,0.1,0.001,start", "10.5,0.2,0.002,", "11.0,0.3,0.003,end"]
    recording = read_recording(csv_file(tmp_path, "\n".join(rows).replace(",", delimiter)))
    assert recording.channels.keys() == {"voltage_command", "position"}
    np.testing.assert_allclose(recording.channels["position"].time, [0.0, 0.5, 1.0])
    np.testing.assert_allclose(recording.channels["position"].values, [0.001, 0.002, 0.003])
    assert (recording.duration, recording.start_stamp) == (1.0, 10_000_000_000)
    assert recording.channels["position"].type == "csv"


def test_the_topics_file_maps_columns(tmp_path: Path) -> None:
    path = csv_file(tmp_path, "t_ms,u,p bar\n0,100,50\n10,200,60\n20,300,70\n")
    topics = tmp_path / "topics.yaml"
    topics.write_text("""
channels:
  time: {column: t_ms, scale: 1.0e-3}
  voltage_command: {column: u, scale: 1.0e-3}
  pressure_a: {column: p bar, scale: 1.0e5, reference: gauge}
""")
    channels = read_recording(path, topics).channels
    np.testing.assert_allclose(channels["voltage_command"].values, [0.1, 0.2, 0.3])
    np.testing.assert_allclose(channels["pressure_a"].values, [5e6, 6e6, 7e6])
    np.testing.assert_allclose(channels["pressure_a"].time, [0.0, 0.01, 0.02])


def test_a_pressure_without_a_word_is_absolute_and_said_so(tmp_path: Path) -> None:
    recording = read_recording(csv_file(tmp_path, "time,pressure_a\n0,5101325\n1,6101325\n"))
    np.testing.assert_allclose(recording.channels["pressure_a"].values, [5e6, 6e6])
    assert any("taken as absolute" in remark for remark in recording.remarks)


def test_gaps_and_words_are_left_out_and_counted(tmp_path: Path) -> None:
    recording = read_recording(csv_file(tmp_path, "time,position,velocity\n0,1,0\n1,,0\n2,n/a,0\n3,4\n"))
    assert recording.channels["position"].values.tolist() == [1.0, 4.0]
    assert recording.channels["velocity"].time.tolist() == [0.0, 1.0, 2.0]
    assert "position (position): 2 cells are empty" in recording.remarks


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no samples"),
        ("time,position\n", "has no samples"),
        ("t,position\n0,1\n1,2\n", r"no column 'time' \(t, position\); name the times"),
        ("0,1\n1,2\n", r"no column 'time' \(column 1, column 2\)"),
        ("time,position,position\n0,1,1\n", r"2 columns are called position; they are position \(1\) and so on"),
        ("time,place\n0,1\n", "no usable channel"),
        ("time,position\nnoon,1\nlate,2\n", "holds no numbers; it must be the time in s"),
        ("time,position\n0,nan\n1,nan\n", "no usable channel"),
        ("time,position\n0,1e9\n", "not plausible for a rig"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(RecordingError, match=message) as caught:
        read_recording(csv_file(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(RecordingError, match="not a text file"):
        read_recording(path)


def test_times_in_ns_and_as_epoch_are_read_to_the_sample(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    count = 50
    for start, step, remark in ((0, 2_000_000, True), (1_726_000_000_000_000_000, 2_000_000, True)):
        rows = "".join(f"{start + k * step},{k * 1e-4}\n" for k in range(count))
        path.write_text(f"time,position\n{rows}")
        recording = read_recording(path)
        np.testing.assert_allclose(recording.channels["position"].time, 2e-3 * np.arange(count), atol=5e-7)
        assert any("taken as ns" in one for one in recording.remarks) == remark
    path.write_text("time,position\n" + "".join(f"{1726000000.25 + k * 2e-3:.6f},{k * 1e-4}\n" for k in range(count)))
    recording = read_recording(path)
    np.testing.assert_allclose(recording.channels["position"].time, 2e-3 * np.arange(count), atol=5e-7)
    assert recording.remarks == ()


def test_a_table_filled_up_with_zeros_is_read_by_its_first_time(tmp_path: Path) -> None:
    stamps = [*(1_726_000_000_000_000_000 + 2_000_000 * k for k in range(50)), 0, 0]
    path = csv_file(tmp_path, "time,position\n" + "".join(f"{stamp},{k}e-4\n" for k, stamp in enumerate(stamps)))
    recording = read_recording(path)
    assert any("taken as ns since 1970" in one for one in recording.remarks)
    np.testing.assert_allclose(recording.channels["position"].time, 2e-3 * np.arange(50), atol=5e-7)


def test_times_in_ms_are_refused_with_the_line_that_reads_them(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("time,position\n" + "".join(f"{2 * k},{k * 1e-4}\n" for k in range(50)))
    with pytest.raises(RecordingError, match=r"`channels: \{time: \{scale: 1\.0e-3\}\}` for ms") as caught:
        read_recording(path)
    topics = tmp_path / "topics.yaml"
    topics.write_text(str(caught.value).split("`")[1])
    assert read_recording(path, topics).duration == pytest.approx(0.098)
    path.write_text("time,position\n" + "".join(f"{k * 1e17:.17g},{k * 1e-4}\n" for k in range(200)))
    with pytest.raises(RecordingError, match="beyond any calendar"):
        read_recording(path)


def test_a_table_of_too_many_columns_is_refused_at_once(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text(",".join(f"c{k}" for k in range(200_000)) + "\n" + "1\n" * 200_000)
    with pytest.raises(RecordingError, match="its header has 200000 columns"):
        read_recording(path)
