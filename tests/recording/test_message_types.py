"""Messages to bytes and back, what a definition may hold, and the ceilings of hostile ones."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from eha_core.errors import RecordingError
from eha_core.recording import definition_of, encode, message_types
from eha_core.recording.message_types import recorded_types, require_type

FLOAT = "std_msgs/msg/Float64"


def test_what_is_left_out_is_zero_or_empty_and_parts_are_built() -> None:
    """Against the type store's own classes."""
    store = get_typestore(Stores.ROS2_JAZZY)
    joints = store.deserialize_cdr(
        encode("sensor_msgs/msg/JointState", {"name": ["a", "b"], "effort": [1.0, 2.0]}), "sensor_msgs/msg/JointState"
    )
    assert (joints.name, joints.effort.tolist(), joints.position.tolist()) == (["a", "b"], [1.0, 2.0], [])  # type: ignore[attr-defined]
    assert (joints.header.frame_id, joints.header.stamp.sec) == ("", 0)  # type: ignore[attr-defined]
    wrench = store.deserialize_cdr(
        encode("geometry_msgs/msg/WrenchStamped", {"wrench": {"force": {"x": 3.0}}}), "geometry_msgs/msg/WrenchStamped"
    )
    assert (wrench.wrench.force.x, wrench.wrench.torque.z) == (3.0, 0.0)  # type: ignore[attr-defined]
    pose = "geometry_msgs/msg/PoseWithCovariance"
    assert store.deserialize_cdr(encode(pose, {}), pose).covariance.tolist() == [0.0] * 36  # type: ignore[attr-defined]
    full = store.deserialize_cdr(encode(pose, {"covariance": np.arange(36.0)}), pose)
    assert full.covariance.tolist() == list(range(36))  # type: ignore[attr-defined]
    assert encode("std_msgs/msg/ByteMultiArray", {"data": [1, 255]})[-2:] == b"\1\xff"
    layout = {"layout": {"dim": [{"label": "row", "size": 2, "stride": 4}, {"label": "column"}]}}
    many = store.deserialize_cdr(encode("std_msgs/msg/Float64MultiArray", layout), "std_msgs/msg/Float64MultiArray")
    assert [(one.label, one.size, one.stride) for one in many.layout.dim] == [("row", 2, 4), ("column", 0, 0)]  # type: ignore[attr-defined]


def test_a_field_that_is_none_is_refused_by_name() -> None:
    with pytest.raises(RecordingError, match="std_msgs/msg/Float64: has no field a, b"):
        encode(FLOAT, {"b": 1.0, "data": 2.0, "a": 3.0})


def test_a_type_is_found_in_any_prefix_and_with_its_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    for prefix, package, name, text in (
        (second, "eha_trial_msgs", "Outer", "eha_trial_parts/Inner[2] pair\nint32 count"),
        (first, "eha_trial_parts", "Inner", "float64 data"),
        (second, "eha_trial_parts", "Inner", "int8 other"),
    ):
        folder = prefix / "share" / package / "msg"
        folder.mkdir(parents=True)
        (folder / f"{name}.msg").write_text(text)
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{first}::{second}")
    data = encode("eha_trial_msgs/msg/Outer", {"pair": [{"data": 1.0}, {"data": 2.0}], "count": 7})
    assert data == b"\0\1\0\0" + np.array([1.0, 2.0]).tobytes() + np.array([7], dtype=np.int32).tobytes()
    assert "float64 data" in definition_of("eha_trial_msgs/msg/Outer")[0]


def test_a_type_that_is_nowhere_or_does_not_parse_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "share" / "eha_broken_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Odd.msg").write_text("float64 = = 3\n[[[")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    with pytest.raises(RecordingError, match="no definition found; install eha_nowhere_msgs or source the workspace"):
        require_type("eha_nowhere_msgs/msg/None")
    with pytest.raises(RecordingError, match=r"Odd\.msg does not parse"):
        require_type("eha_broken_msgs/msg/Odd")


def test_a_definition_s_package_is_not_imported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "eha_trap").mkdir()
    (tmp_path / "eha_trap" / "__init__.py").write_text("raise SystemExit('imported')")
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    with pytest.raises(RecordingError, match="no definition found"):
        require_type("eha_trap.inner/msg/None")


def is_its_own(definition: str, type_name: str = "trial_msgs/msg/Trial") -> bool:
    """Whether the file's own definition is used; else one that is installed is sought, which there is not."""
    try:
        store, remark = recorded_types(type_name, "ros2msg", definition)
    except RecordingError:
        return False
    assert remark is None and type_name in store.fielddefs
    return True


def nested(levels: int) -> str:
    """A type of so many levels, the last of one number."""
    row = "\n" + "=" * 80 + "\n"
    inner = [*(f"trial_msgs/T{k} inner" for k in range(2, levels + 1)), "float64 data"]
    return row.join([inner[0], *(f"MSG: trial_msgs/T{k}\n{text}" for k, text in enumerate(inner[1:], start=2))])


@pytest.mark.parametrize(("levels", "is_used"), [(1, True), (2, True), (20, True), (21, False)])
def test_types_go_twenty_levels_deep(levels: int, is_used: bool) -> None:
    assert is_its_own(nested(levels)) == is_used


@pytest.mark.parametrize(
    ("definition", "is_used"),
    [
        ("float64[1048575] data", True),  # with the message itself 2^20
        ("float64[1048576] data", False),
        ("float64[] data", True),
        ("float64[1024] one\nfloat64[1047551] other", True),
        ("float64[1024] one\nfloat64[1047552] other", False),
        (f"trial_msgs/Part[1023] parts\n{'=' * 80}\nMSG: trial_msgs/Part\nfloat64[1023] data", True),
        (f"trial_msgs/Part[1024] parts\n{'=' * 80}\nMSG: trial_msgs/Part\nfloat64[1023] data", False),
        (f"trial_msgs/Part[] parts\n{'=' * 80}\nMSG: trial_msgs/Part\nfloat64[1023] data", True),
        ("trial_msgs/Missing part", False),
    ],
)
def test_a_message_has_a_million_fixed_elements_at_most(definition: str, is_used: bool) -> None:
    assert is_its_own(definition) == is_used


@pytest.mark.parametrize(("length", "is_used"), [(2**17, True), (2**17 + 1, False)])
def test_a_definition_has_131072_characters_at_most(length: int, is_used: bool) -> None:
    text = "float64 data\n"
    assert is_its_own(text + "#" * (length - len(text))) == is_used


def test_a_damaged_definition_gives_way_to_the_installed_one() -> None:
    store, remark = recorded_types(FLOAT, "ros2msg", "float64 = =")
    assert store is message_types.typestore()
    assert remark == f"the definition of {FLOAT} in the file cannot be used; the installed one was taken"
    assert recorded_types(FLOAT, "ros2msg", " \n") == (message_types.typestore(), None)
    own, remark = recorded_types(FLOAT, "ros2msg", "float32 data")
    assert remark is None and own is not message_types.typestore()


def test_a_definition_in_idl_is_read_as_such() -> None:
    text = "module trial_msgs { module msg { struct Trial { double data; }; }; };"
    store, remark = recorded_types("trial_msgs/msg/Trial", "ros2idl", text)
    assert remark is None and [name for name, _ in store.fielddefs["trial_msgs/msg/Trial"][1]] == ["data"]
    assert not is_its_own(text)
