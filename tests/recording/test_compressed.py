"""Bags that rosbag2 compresses: each message, or whole files, in either storage."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recordings import SECOND, START, header
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from eha_core.errors import RecordingError
from eha_core.recording import read_recording
from eha_core.recording.inspection import inspect_file

STORE = get_typestore(Stores.ROS2_JAZZY)
COUNT = 300


def a_bag(folder: Path, mode: CompressionMode, storage: StoragePlugin) -> Path:
    """A bag of other hands: pressure of chamber A, k Pa over 5 MPa at 100 Hz."""
    path = folder / "bag"
    writer = Writer(path, version=9, storage_plugin=storage)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    kind = "sensor_msgs/msg/FluidPressure"
    message, head, time = (
        STORE.types[kind],
        STORE.types["std_msgs/msg/Header"],
        STORE.types["builtin_interfaces/msg/Time"],
    )
    with writer:
        connection = writer.add_connection("/chamber_a/pressure", kind, typestore=STORE)
        for k in range(COUNT):
            stamp = START + k * SECOND // 100
            of = header(stamp)["stamp"]
            made = message(head(time(of["sec"], of["nanosec"]), ""), 5e6 + k, 0.0)
            writer.write(connection, stamp, STORE.serialize_cdr(made, kind))
    return path


MODES = [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE]


@pytest.mark.parametrize("storage", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
@pytest.mark.parametrize("mode", MODES)
def test_a_compressed_bag_gives_what_was_written(tmp_path: Path, mode: CompressionMode, storage: StoragePlugin) -> None:
    folder = a_bag(tmp_path, mode, storage)
    (file,) = [one for one in folder.iterdir() if one.name != "metadata.yaml"]
    assert file.suffix == (".zstd" if mode is CompressionMode.FILE else file.suffix)
    for path in (folder, file):
        channel = read_recording(path).channels["pressure_a"]
        np.testing.assert_allclose(channel.values + 101325.0, 5e6 + np.arange(COUNT))
        np.testing.assert_allclose(channel.time, np.arange(COUNT) / 100.0, atol=1e-9)
        (field,) = inspect_file(path).fields
        assert (field.count, field.low) == (COUNT, 5e6)


def test_a_file_that_does_not_unpack_is_refused_by_its_name(tmp_path: Path) -> None:
    folder = a_bag(tmp_path, CompressionMode.FILE, StoragePlugin.MCAP)
    (file,) = folder.glob("*.zstd")
    content = file.read_bytes()
    file.write_bytes(content[:40] + bytes(20) + content[60:])
    with pytest.raises(RecordingError, match=f"{file.name}: cannot be unpacked") as caught:
        read_recording(file)
    assert "/tmp/eha-" not in str(caught.value)


def test_a_file_that_unpacks_without_end_is_refused(tmp_path: Path) -> None:
    from zstandard import ZstdCompressor

    path = tmp_path / "bomb.mcap.zstd"
    path.write_bytes(ZstdCompressor().compress(bytes(200_000_000)))
    with pytest.raises(RecordingError, match="unpacks to more than"):
        read_recording(path)


def test_what_is_no_bag_inside_is_refused_by_the_name_outside(tmp_path: Path) -> None:
    from zstandard import ZstdCompressor

    path = tmp_path / "run.mcap.zstd"
    path.write_bytes(ZstdCompressor().compress(b"no bag at all"))
    with pytest.raises(RecordingError, match=f"{path}: not an MCAP file"):
        read_recording(path)


def test_an_element_of_a_command_s_array_is_asked_after(tmp_path: Path) -> None:
    from eha_core.recording import RecordingWriter
    from eha_core.recording.suggestions import suggest

    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        for k in range(COUNT):
            layout = {"dim": [], "data_offset": 0}
            fields = {"layout": layout, "data": [0.0, np.sin(0.1 * k)]}
            writer.write_fields(
                "/forward_effort_controller/commands",
                "std_msgs/msg/Float64MultiArray",
                fields,
                START + k * SECOND // 100,
            )
    (question,) = suggest(inspect_file(path)).questions
    assert question.channel == "voltage_command"
    assert [one and one.field.path for one in question.readings] == ["data[1]"]
