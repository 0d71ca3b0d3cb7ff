"""What recordings come in: files and folders of this library and of others, and what is none."""

from __future__ import annotations

from pathlib import Path

import apsw
import numpy as np
import pytest
from numpy.typing import NDArray
from recordings import SECOND, START, piston_recording
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from eha_core.errors import RecordingError
from eha_core.recording import RecordingWriter, read_recording, unpacking
from eha_core.recording.bag import bag_extent, bag_metadata, bag_size, bag_topics, read_bag

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


def written(folder: Path, count: int) -> Path:
    """The .db3 of a bag with so many voltages, a second and 0.1 V apart."""
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(folder, version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/voltage_command", FLOAT, typestore=store)
        for k in range(count):
            message = store.types[FLOAT](data=k * 0.1)  # type: ignore[call-arg]
            writer.write(connection, START + k * SECOND, store.serialize_cdr(message, FLOAT))
    (path,) = folder.glob("*.db3")
    return path


@pytest.mark.parametrize("stamp", ["'soon'", "0.5e300", "x'00'"])
def test_a_stamp_that_is_no_whole_number_ends_what_can_be_read(tmp_path: Path, stamp: str) -> None:
    """SQLite keeps any value in any column."""
    path = written(tmp_path / "bag", 4)
    database = apsw.Connection(str(path))
    database.execute(f"UPDATE messages SET timestamp = {stamp} WHERE id = (SELECT max(id) FROM messages)")
    database.close()
    recording = read_recording(path)
    assert recording.damaged is not None and "damaged place" in recording.damaged
    np.testing.assert_allclose(recording.channels["voltage_command"].values, [0.0, 0.1, 0.2])


@pytest.fixture
def database(tmp_path: Path) -> Path:
    """A .db3 of 6 messages of 12 bytes each: 4 that say how it is encoded, and a double."""
    return written(tmp_path / "bag", 6)


@pytest.mark.parametrize(("room", "is_enough"), [(6 * (12 + 32), True), (6 * (12 + 32) - 1, False)])
def test_each_message_of_a_database_counts_with_its_row(
    database: Path, room: int, is_enough: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(unpacking, "ROOM", room)
    monkeypatch.setattr(unpacking, "LARGEST_RATIO", 0)
    if is_enough:
        assert len(read_recording(database).channels["voltage_command"].values) == 6
    else:
        with pytest.raises(RecordingError, match="unpacks to more than 0 MB, as no recording of its size does"):
            read_recording(database)


def test_a_file_s_ceiling_is_32_mib_and_a_hundred_times_its_size() -> None:
    ceiling = unpacking.Ceiling("run.db3", 5000)
    ceiling.take(32 * 2**20)
    ceiling.take(499_999)
    ceiling.take(1)
    with pytest.raises(RecordingError, match=r"run.db3: unpacks to more than 34 MB"):
        ceiling.take(1)


def test_a_folder_has_the_size_and_the_metadata_of_all_its_files(tmp_path: Path, database: Path) -> None:
    folder = tmp_path / "split"
    for number, values in enumerate(({"moving_mass": 9.0, "piston_area": 1e-3}, {"moving_mass": 8.0})):
        with RecordingWriter(folder / f"bag_{number}.mcap", values) as writer:
            writer.write_fields("/voltage_command", FLOAT, {"data": 1.0}, START)
    assert bag_size(folder) == sum(len(file.read_bytes()) for file in folder.iterdir())
    assert bag_size(database) == len(database.read_bytes())
    ((_, stored),) = bag_metadata(folder).items()
    assert {name: float(text) for name, text in stored.items()} == {"moving_mass": 8.0, "piston_area": 1e-3}
    assert bag_metadata(folder / "bag_1.mcap").keys() == bag_metadata(folder).keys()
    assert bag_metadata(database) == {} and bag_extent(database) is None
    assert (bag_size(tmp_path / "none.mcap"), bag_metadata(tmp_path / "none.mcap")) == (0, {})


def test_a_folder_s_extent_is_from_the_first_to_the_last_of_its_files_whatever_their_order(tmp_path: Path) -> None:
    for number, second in enumerate((5, 0, 2)):
        piston_recording(tmp_path / f"bag_{number}.mcap", count=10, start=START + second * SECOND)
    assert bag_extent(tmp_path) == pytest.approx(5.09, abs=1e-9)


def test_the_topics_of_a_folder_are_those_of_all_files_that_can_be_read(tmp_path: Path) -> None:
    piston_recording(tmp_path / "bag_0.mcap", count=2, topics=("joint_states",))
    (tmp_path / "bag_1.mcap").write_bytes(b"no MCAP at all")
    piston_recording(tmp_path / "bag_2.mcap", count=3, topics=("voltage_command", "joint_states"))
    assert set(bag_topics(tmp_path)) == {"/joint_states", "/voltage_command"}
    sinks = {name: _Counted() for name in bag_topics(tmp_path)}
    raw = read_bag(tmp_path, sinks)
    assert raw.counts == {"/joint_states": 5, "/voltage_command": 3}
    assert {name: one.count for name, one in sinks.items()} == raw.counts
    assert len(raw.damage) == 1 and raw.damage[0].startswith("bag_1.mcap: ")


class _Counted:
    """A sink that counts."""

    count = 0

    def add(self, log_time: int, payload: bytes) -> None:
        self.count += 1

    def add_block(
        self, content: bytes, starts: NDArray[np.int64], lengths: NDArray[np.int64], log_times: object
    ) -> None:
        self.count += len(starts)


def test_a_folder_whose_only_file_cannot_be_read_is_refused(tmp_path: Path) -> None:
    (tmp_path / "bag_0.mcap").write_bytes(b"no MCAP at all")
    for read in (bag_topics, lambda path: read_bag(path, {})):
        with pytest.raises(RecordingError, match="not an MCAP file"):
            read(tmp_path)


def test_files_come_by_their_numbers_and_the_one_without_first(tmp_path: Path) -> None:
    """Each says where it was: the parameter of the last file stays."""
    for number, name in ((3, "bag_10"), (2, "bag_9"), (1, "bag_0"), (0, "bag")):
        with RecordingWriter(tmp_path / f"{name}.mcap", {"moving_mass": 1.0 + number}) as writer:
            writer.write_fields("/voltage_command", FLOAT, {"data": float(number)}, START)
            writer.write_fields("/voltage_command", FLOAT, {"data": float(number)}, START + (1 + number) * SECOND)
    recording = read_recording(tmp_path)
    assert recording.parameters == {"moving_mass": 4.0}
    assert recording.channels["voltage_command"].values.tolist() == [0.0, 0.0, 1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("listed", "message"),
    [
        ("[../bag_0.mcap]", r"lists \.\./bag_0.mcap, which is not in its folder"),
        ("[bag_0.mcap, /tmp/bag_0.mcap]", "lists /tmp/bag_0.mcap, which is not in its folder"),
        ("7", "lists no files; remove it"),
        ("[bag_0.mcap], files: [&a 1, *a]", "aliases are not read; .*; remove it"),
    ],
)
def test_a_list_of_files_that_leads_elsewhere_is_refused(tmp_path: Path, listed: str, message: str) -> None:
    piston_recording(tmp_path / "bag_0.mcap", count=2)
    description = tmp_path / "metadata.yaml"
    description.write_text(f"rosbag2_bagfile_information: {{relative_file_paths: {listed}}}")
    with pytest.raises(RecordingError, match=message):
        read_recording(tmp_path)
    description.write_text("rosbag2_bagfile_information: {relative_file_paths: [bag_0.mcap]}")
    assert len(read_recording(tmp_path).channels["position"].time) == 2
