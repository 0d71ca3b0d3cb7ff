"""What recordings come in: files and folders of this library and of others, and what is none."""

from __future__ import annotations

from pathlib import Path

import apsw
import numpy as np
import pytest
from recordings import SECOND, START, piston_recording
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from eha_core.errors import RecordingError
from eha_core.recording import read_recording
from eha_core.recording.bag import bag_extent

FLOAT = "std_msgs/msg/Float64"


@pytest.mark.parametrize("plugin", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_a_rosbag2_folder_of_other_hands_is_read(tmp_path: Path, plugin: StoragePlugin) -> None:
    folder = tmp_path / "bag"
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        connection = writer.add_connection("/rig/voltage_command", FLOAT, typestore=store)
        for k in range(6):
            message = store.types[FLOAT](data=k * 0.1)  # type: ignore[call-arg]
            writer.write(connection, START + k * SECOND, store.serialize_cdr(message, FLOAT))
    (file,) = (file for file in folder.iterdir() if file.suffix != ".yaml")
    for path in (folder, file):
        channel = read_recording(path).channels["voltage_command"]
        np.testing.assert_allclose(channel.values, np.arange(6) * 0.1)
        np.testing.assert_allclose(channel.time, np.arange(6))


def test_the_files_of_a_split_folder_are_joined_in_order(tmp_path: Path) -> None:
    folder = tmp_path / "bag"
    for number in range(11):
        piston_recording(folder / f"bag_{number}.mcap", count=10, start=START + number * SECOND)
    recording = read_recording(folder)
    assert len(recording.channels["position"].time) == 110
    assert (recording.duration, recording.remarks) == (pytest.approx(10.09), ())


def test_a_folders_extent_is_told_by_its_files_ends(tmp_path: Path) -> None:
    folder = tmp_path / "bag"
    for number in (0, 1):
        piston_recording(folder / f"bag_{number}.mcap", count=10, start=START + number * SECOND)
    assert bag_extent(folder) == pytest.approx(1.09, abs=1e-9)
    assert bag_extent(folder / "bag_0.mcap") == pytest.approx(0.09, abs=1e-9)
    cut = folder / "bag_1.mcap"
    cut.write_bytes(cut.read_bytes()[:400])
    assert bag_extent(folder) is None
    assert bag_extent(tmp_path / "none.mcap") is None


def test_what_comes_after_a_file_that_cannot_be_read_is_read(tmp_path: Path) -> None:
    folder = tmp_path / "bag"
    for number in (0, 2):
        piston_recording(folder / f"bag_{number}.mcap", count=10, start=START + number * SECOND)
    (folder / "bag_1.mcap").write_bytes(b"no MCAP at all")
    recording = read_recording(folder)
    assert len(recording.channels["position"].time) == 20
    assert recording.damaged is not None and "bag_1.mcap" in recording.damaged


def test_a_folder_of_several_recordings_is_refused_by_name(tmp_path: Path) -> None:
    for name in ("run_a.mcap", "run_b.mcap"):
        piston_recording(tmp_path / name, count=1)
    with pytest.raises(RecordingError, match=r"several recordings \(run_a.mcap, run_b.mcap\); name one"):
        read_recording(tmp_path)


def test_a_folder_with_a_missing_file_is_damaged(tmp_path: Path) -> None:
    folder = tmp_path / "bag"
    piston_recording(folder / "bag_0.mcap", count=5)
    (folder / "metadata.yaml").write_text(
        "rosbag2_bagfile_information: {relative_file_paths: [bag_0.mcap, bag_1.mcap]}"
    )
    recording = read_recording(folder)
    assert recording.damaged is not None and "bag_1.mcap: cannot be read (No such file" in recording.damaged


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("absent.mcap", None, "there is no such file or folder"),
        ("empty.mcap", b"", "the file is empty"),
        ("text.mcap", b"hello, this is a text file", "not an MCAP file"),
        ("broken.db3", b"SQLite format 3\0 and no more", "cannot be read as a rosbag2 file"),
        ("folder/none.txt", b"x", "holds no recording"),
    ],
)
def test_what_is_no_recording_is_refused_in_one_line(
    tmp_path: Path, name: str, content: bytes | None, message: str
) -> None:
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RecordingError, match=message) as caught:
        read_recording(path.parent if "folder" in name else path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("stamp", ["'soon'", "0.5e300", "x'00'"])
def test_a_stamp_that_is_no_whole_number_ends_what_can_be_read(tmp_path: Path, stamp: str) -> None:
    """SQLite keeps any value in any column."""
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(tmp_path / "bag", version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/voltage_command", FLOAT, typestore=store)
        for k in range(4):
            message = store.types[FLOAT](data=k * 0.1)  # type: ignore[call-arg]
            writer.write(connection, START + k * SECOND, store.serialize_cdr(message, FLOAT))
    (path,) = (tmp_path / "bag").glob("*.db3")
    database = apsw.Connection(str(path))
    database.execute(f"UPDATE messages SET timestamp = {stamp} WHERE id = (SELECT max(id) FROM messages)")
    database.close()
    recording = read_recording(path)
    assert recording.damaged is not None and "damaged place" in recording.damaged
    np.testing.assert_allclose(recording.channels["voltage_command"].values, [0.0, 0.1, 0.2])
