"""What a file holds, as `eha inspect` lists it: each number's count, range, rate, step and unit."""

from __future__ import annotations

from math import isnan
from pathlib import Path

import numpy as np
import pytest
from recordings import SECOND, START, header

from eha_core.errors import RecordingError
from eha_core.recording import RecordingWriter, inspection
from eha_core.recording.inspection import Field, inspect_file
from eha_core.recording.stated_units import unit_of_name

JOINTS, FLOAT, PRESSURE = "sensor_msgs/msg/JointState", "std_msgs/msg/Float64", "sensor_msgs/msg/FluidPressure"


def a_table(folder: Path, head: str, rows: list[str]) -> dict[str, Field]:
    path = folder / "run.csv"
    path.write_text("\n".join([head, *rows]) + "\n")
    return {one.path: one for one in inspect_file(path).fields}


def test_a_column_is_listed_with_what_its_numbers_say(tmp_path: Path) -> None:
    fields = a_table(tmp_path, "time,weg_mm,dead,twice", ["0.5,3,,0", "0.6,-7,,0", "0.8,,,1", "1.0,5,,1", "1.2,4,,2"])
    time, way = fields["time"], fields["weg_mm"]
    assert (time.topic, time.count, time.low, time.high, time.first) == ("", 5, 0.5, 1.2, 0.5)
    assert time.step == pytest.approx(0.2)  # the median of 0.1, 0.2, 0.2, 0.2
    assert (way.count, way.low, way.high, way.first, way.step, way.unit) == (4, -7.0, 5.0, 3.0, 0.0, "mm")
    assert fields["twice"].step == 0.5  # of 0, 1, 0, 1: it stands at times, and never goes back
    assert isnan(time.rate) and time.reference is None
    if "dead" in fields:
        dead = fields["dead"]
        assert (dead.count, dead.unit, dead.step) == (0, "", 0.0) and isnan(dead.low) and isnan(dead.first)


def test_a_column_that_stands_or_goes_back_has_no_step(tmp_path: Path) -> None:
    fields = a_table(tmp_path, "time,still,back", [f"{k},4,{(0, 1, 2, 1.9, 3)[k]}" for k in range(5)])
    assert (fields["still"].step, fields["back"].step, fields["time"].step) == (0.0, 0.0, 1.0)
    alone = a_table(tmp_path, "time,x", ["0,4"])
    assert (alone["time"].step, alone["x"].step) == (0.0, 0.0)


def test_counts_of_ns_since_1970_have_steps_that_a_float_cannot_tell(tmp_path: Path) -> None:
    fields = a_table(tmp_path, "time,x", [f"2024-09-10T20:26:40.{125 * k:09d}Z,{k}" for k in range(30)])
    assert (fields["time"].step, fields["time"].unit) == (125.0, "ns")


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("x_mm", "mm"), ("weg/mm", "mm"), ("druck bar", "bar"), ("p_A (bar)", "bar"), ("q_l/min", "l/min"),
        ("v_mm/s", "mm/s"), ("n_rpm", "rpm"),
        ("p_A", ""), ("x_m", ""), ("i_A", "A"), ("u_V", "V"), ("v_V", "V"), ("f_N", "N"), ("t_s", "s"), ("p_s", ""),
        ("kraft_N", "N"), ("ab_N", ""), ("weg_m", "m"), ("x_B", ""), ("x_head", ""), ("mm", ""), ("x", ""),
    ],
)  # fmt: skip
def test_the_unit_that_a_name_states(name: str, unit: str) -> None:
    """One letter is a unit after a word of three letters or where it is the usual one, and else a part of the name."""
    assert unit_of_name(name) == unit


@pytest.mark.parametrize("more", [0, 1, 3])
def test_no_more_than_200_columns_are_listed(tmp_path: Path, more: int) -> None:
    path = tmp_path / "wide.csv"
    names = ["time", *(f"c{k}" for k in range(199 + more))]
    path.write_text("\n".join([",".join(names), *(",".join([str(k)] * len(names)) for k in range(3))]) + "\n")
    found = inspect_file(path)
    assert [one.path for one in found.fields] == names[:200]
    assert found.remarks == ((f"{more} columns more are not listed",) if more else ())
    assert (found.kind, found.topics, found.damaged) == ("csv", {}, None)


def a_bag(folder: Path, count: int, period: int, flush_period: float = 1e9) -> Path:
    path = folder / "run.mcap"
    with RecordingWriter(path, flush_period=flush_period) as writer:
        for k in range(count):
            stamp = START + k * period
            joints = {
                "header": header(stamp), "name": ["boom", "piston"], "position": [0.5, k * 1e-3],
                "velocity": [np.nan, -1.0 * k],
            }  # fmt: skip
            writer.write_fields("/rig/joint_states", JOINTS, joints, stamp)
            writer.write_fields("/rig/p", PRESSURE, {"header": header(stamp), "fluid_pressure": 1e5 + k}, stamp)
            writer.write_fields("/gain", FLOAT, {"data": 7.0 - k}, stamp)
    return path


@pytest.mark.parametrize("block", [4096, 3])
def test_a_topic_s_numbers_are_listed_by_name_with_range_and_rate(
    tmp_path: Path, block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(inspection, "BLOCK", block)
    found = inspect_file(a_bag(tmp_path, 11, SECOND // 50))
    assert (found.kind, found.damaged, found.remarks) == ("bag", None, ())
    assert found.topics == {"/rig/joint_states": JOINTS, "/rig/p": PRESSURE, "/gain": FLOAT}
    fields = {(one.topic, one.path): one for one in found.fields}
    piston = fields["/rig/joint_states", "position[piston]"]
    assert (piston.count, piston.low, piston.high, piston.unit) == (11, 0.0, 0.01, "m")
    assert piston.rate == pytest.approx(50.0)
    assert isnan(piston.first) and piston.step == 0.0
    assert fields["/rig/joint_states", "velocity[boom]"].count == 0
    assert isnan(fields["/rig/joint_states", "velocity[boom]"].rate)
    speed = fields["/rig/joint_states", "velocity[piston]"]
    assert (speed.low, speed.high, speed.unit) == (-10.0, 0.0, "m/s")
    pressure = fields["/rig/p", "fluid_pressure"]
    assert (pressure.unit, pressure.reference, pressure.high) == ("Pa", "absolute", 1e5 + 10)
    gain = fields["/gain", "data"]
    assert (gain.unit, gain.reference, gain.low, gain.high) == ("", None, -3.0, 7.0)
    assert ("/rig/p", "variance") not in fields and not any("header" in path for _, path in fields)


def test_one_message_has_no_rate(tmp_path: Path) -> None:
    assert all(isnan(one.rate) for one in inspect_file(a_bag(tmp_path, 1, SECOND)).fields)


def test_two_messages_have_one(tmp_path: Path) -> None:
    rates = [one.rate for one in inspect_file(a_bag(tmp_path, 2, SECOND // 4)).fields if one.count == 2]
    assert len(rates) == 5 and rates == pytest.approx([4.0] * 5)


@pytest.mark.parametrize("count", [12, 13])
def test_a_nameless_array_is_listed_up_to_twelve_numbers(tmp_path: Path, count: int) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        writer.write_fields("/many", "std_msgs/msg/Float64MultiArray", {"data": [1.0] * count}, START)
        writer.write_fields("/gain", FLOAT, {"data": 1.0}, START)
    paths = [one.path for one in inspect_file(path).fields if one.topic == "/many" and one.path.startswith("data[")]
    assert paths == ([f"data[{k}]" for k in range(12)] if count == 12 else [])


@pytest.mark.parametrize("names", [["a", "a"], ["1", "2"], ["a", ""], ["a[0]", "b"], ["a"]])
def test_joints_whose_names_tell_nothing_are_listed_by_number(tmp_path: Path, names: list[str]) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        writer.write_fields("/joint_states", JOINTS, {"name": names, "position": [1.0, 2.0]}, START)
    assert [one.path for one in inspect_file(path).fields] == ["position[0]", "position[1]"]


@pytest.mark.parametrize(("count", "more"), [(200, 0), (201, 1), (205, 5)])
def test_no_more_than_200_numbers_of_a_topic_are_listed(tmp_path: Path, count: int, more: int) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        joints = {"name": [f"j{k}" for k in range(count)], "position": [1.0] * count}
        writer.write_fields("/joint_states", JOINTS, joints, START)
    found = inspect_file(path)
    assert [one.path for one in found.fields] == [f"position[j{k}]" for k in range(200)]
    assert found.remarks == ((f"/joint_states: {more} numbers more are not listed",) if more else ())


def test_parts_that_have_a_name_are_listed_by_it(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    parts = [{"name": "x", "offset": 4, "count": 2}, {"name": "7", "offset": 8, "count": 3}]
    with RecordingWriter(path) as writer:
        writer.write_fields("/cloud", "sensor_msgs/msg/PointCloud2", {"fields": parts}, START)
    found = {one.path: one.high for one in inspect_file(path).fields if one.path.startswith("fields")}
    assert {name: high for name, high in found.items() if "datatype" not in name} == {
        "fields[x].offset": 4.0, "fields[x].count": 2.0, "fields[1].offset": 8.0, "fields[1].count": 3.0
    }  # fmt: skip


def test_what_is_nothing_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="there is no such file or folder"):
        inspect_file(tmp_path / "none.csv")
    with pytest.raises(RecordingError, match="is neither a file nor a folder"):
        inspect_file("/dev/null")
