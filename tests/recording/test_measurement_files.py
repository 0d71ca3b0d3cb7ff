"""Workbooks, TDMS, MDF and HDF5 files, each written by its own library, give the run that was written."""

from __future__ import annotations

import sys
from datetime import datetime, timedelta
from pathlib import Path

import h5py
import numpy as np
import pytest
from asammdf import MDF, Signal, Source
from asammdf.blocks.v4_constants import BUS_TYPE_CAN, SOURCE_BUS
from example_run import COUNT, PERIOD, RUN, TIME
from nptdms import ChannelObject, TdmsWriter
from openpyxl import Workbook
from peoples_logs import GAUGE, MILLIMETRES
from test_peoples_logs import topics_of

from eha_core.errors import RecordingError
from eha_core.recording import Recording, read_recording
from eha_core.tables import read_table


def read_back(path: Path) -> Recording:
    """The file by the topics file that is written for it, which asks nothing."""
    topics, asked = topics_of(path)
    assert asked == {}
    return read_recording(path, topics)


def require_run(recording: Recording, every: int = 1) -> None:
    """The run; position and pressure of chamber B at a part of the instants."""
    expected = {
        "voltage_command": (RUN.voltage, 1), "position": (RUN.position, every), "pressure_a": (RUN.pressure_a, 1),
        "pressure_b": (RUN.pressure_b, every),
    }  # fmt: skip
    assert set(recording.channels) == set(expected)
    for name, (values, step) in expected.items():
        channel = recording.channels[name]
        np.testing.assert_allclose(channel.values, values[::step], rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(channel.time, TIME[::step], atol=2e-6)


@pytest.mark.parametrize("is_dated", [False, True])
def test_a_workbook_gives_the_sheet_with_most_rows(tmp_path: Path, is_dated: bool) -> None:
    path, book = tmp_path / "run.xlsx", Workbook()
    notes = book.active
    assert notes is not None
    notes.title = "notes"
    notes.append(["operator", "lab"])
    notes.append(["rig", 7])
    sheet = book.create_sheet("data")
    sheet.append(["Measured with care"])
    sheet.append(
        ["Time" if is_dated else "Time [s]", "Valve [V]", "Stroke [mm]", "Pressure A [bar]", "Pressure B [bar]"]
    )
    start = datetime(2026, 11, 26, 21, 4, 52)
    for k in range(COUNT):
        instant = start + timedelta(milliseconds=k) if is_dated else k * PERIOD
        sheet.append([instant, RUN.voltage[k], MILLIMETRES[k], GAUGE[0][k], GAUGE[1][k]])
    book.save(path)
    require_run(read_back(path))
    assert "of the sheets, data was read; notes left out" in read_table(path).remarks


def test_a_workbook_that_unpacks_without_end_is_refused(tmp_path: Path) -> None:
    from zipfile import ZIP_DEFLATED, ZipFile

    path = tmp_path / "bomb.xlsx"
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        archive.writestr("xl/worksheets/sheet1.xml", b"0" * 300_000_000)
    with pytest.raises(RecordingError, match="unpacks to more than a workbook of its size may"):
        read_table(path)


@pytest.mark.parametrize("every", [1, 4])
def test_a_tdms_file_gives_each_channel_on_its_own_time(tmp_path: Path, every: int) -> None:
    path = tmp_path / "run.tdms"
    named = [("Valve", "V", RUN.voltage, 1), ("Stroke", "mm", MILLIMETRES, every)]
    named += [("Pressure A", "bar", GAUGE[0], 1), ("Pressure B", "bar", GAUGE[1], every)]
    with TdmsWriter(path) as writer:
        for name, unit, values, step in named:
            properties = {"unit_string": unit, "wf_increment": step * PERIOD, "wf_start_offset": 0.0}
            writer.write_segment([ChannelObject("rig", name, values[::step], properties)])
    require_run(read_back(path), every)


@pytest.mark.parametrize("every", [1, 4])
def test_an_mdf_file_gives_each_signal_on_its_own_time(tmp_path: Path, every: int) -> None:
    path = tmp_path / "run.mf4"
    with MDF() as file:
        for name, unit, values, step in (
            ("ValveVoltage", "V", RUN.voltage, 1), ("PistonPosition", "mm", MILLIMETRES, every),
            ("PressureA", "bar", GAUGE[0], 1), ("PressureB", "bar", GAUGE[1], every),
        ):  # fmt: skip
            file.append([Signal(values[::step], TIME[::step], unit=unit, name=name)])
        file.save(path)
    require_run(read_back(path), every)


DATABASE = """VERSION ""
NS_ :
BS_:
BU_: Rig
BO_ 257 Motion: 8 Rig
 SG_ ValveVoltage : 0|32@1- (1e-9,0) [-2|2] "V" Rig
 SG_ PistonPosition : 32|32@1- (1e-6,0) [-2000|2000] "mm" Rig
BO_ 258 Pressures: 8 Rig
 SG_ PressureA : 0|32@1- (1e-6,0) [-2000|2000] "bar" Rig
 SG_ PressureB : 32|32@1- (1e-6,0) [-2000|2000] "bar" Rig
"""
"""A network's database: what the bytes of two messages mean."""


def bus_log(path: Path) -> Path:
    """The run as a bus logger writes it: two frames at each instant, not decoded."""
    pairs = ((257, RUN.voltage / 1e-9, MILLIMETRES / 1e-6), (258, GAUGE[0] / 1e-6, GAUGE[1] / 1e-6))
    heads = [("BusChannel", "<u1"), ("ID", "<u4"), ("IDE", "<u1"), ("DLC", "<u1"), ("DataLength", "<u1")]
    kind = np.dtype([*((f"CAN_DataFrame.{name}", one) for name, one in heads), ("CAN_DataFrame.DataBytes", "(8,)u1")])
    frames = np.zeros(2 * COUNT, kind)
    frames["CAN_DataFrame.BusChannel"] = 1
    frames["CAN_DataFrame.DLC"] = frames["CAN_DataFrame.DataLength"] = 8
    for k, (number, *values) in enumerate(pairs):
        frames["CAN_DataFrame.ID"][k::2] = number
        counts = np.round(np.stack(values, axis=1)).astype("<i4")
        frames["CAN_DataFrame.DataBytes"][k::2] = counts.view(np.uint8)
    bus = Source(name="CAN1", path="CAN1", comment="", source_type=SOURCE_BUS, bus_type=BUS_TYPE_CAN)
    with MDF() as file:
        file.append([Signal(frames, np.repeat(TIME, 2), name="CAN_DataFrame", source=bus)])
        file.save(path)
    return path


def test_frames_of_a_bus_are_decoded_by_the_database_beside_them(tmp_path: Path) -> None:
    path = bus_log(tmp_path / "run.mf4")
    (tmp_path / "run.dbc").write_text(DATABASE)
    read = read_back(path)
    assert {"position", "pressure_a", "pressure_b"} <= set(read.channels)
    require_run(read)


@pytest.mark.parametrize(
    ("database", "message"),
    [
        (None, "run.mf4: holds raw CAN frames; put their database beside it as run.dbc"),
        (DATABASE.replace("257", "357").replace("258", "358"), "run.dbc describes none of its CAN frames"),
    ],
)
def test_frames_of_a_bus_without_their_database_are_refused_by_what_they_are(
    tmp_path: Path, database: str | None, message: str
) -> None:
    path = bus_log(tmp_path / "run.mf4")
    if database is not None:
        (tmp_path / "run.dbc").write_text(database)
    with pytest.raises(RecordingError, match=message) as caught:
        read_table(path)
    assert "\n" not in str(caught.value)


def test_an_hdf5_file_is_read_like_matlab_s(tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    with h5py.File(path, "w") as file:
        for name, values in (("time", TIME), ("valve_V", RUN.voltage), ("stroke_mm", MILLIMETRES)):
            file[f"rig/{name}"] = values
        file["rig/p_head_bar"], file["rig/p_rod_bar"] = GAUGE
    require_run(read_back(path))


@pytest.mark.parametrize(("ending", "package"), [("xlsx", "openpyxl"), ("tdms", "nptdms"), ("mf4", "asammdf")])
def test_a_library_that_is_missing_is_named_with_what_installs_it(
    tmp_path: Path, ending: str, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"run.{ending}"
    path.write_bytes(b"PK\x03\x04" + b"\0" * 100)
    for module in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(RecordingError, match=f"are read by {package}; install it: pip install {package}"):
        read_table(path)


@pytest.mark.parametrize("ending", ["xlsx", "tdms", "mf4"])
@pytest.mark.parametrize(
    "content", [b"", b"PK\x03\x04" + b"\0" * 100, b"TDSm" + b"\xff" * 60, b"MDF     4.10" + b"\xff" * 99]
)
def test_a_damaged_file_is_refused_in_one_line(tmp_path: Path, ending: str, content: bytes) -> None:
    path = tmp_path / f"run.{ending}"
    path.write_bytes(content)
    with pytest.raises(RecordingError) as caught:
        read_table(path)
    assert "\n" not in str(caught.value)
