"""Workbooks, TDMS, MDF and HDF5 files, each written by its own library, give the run that was written."""

from __future__ import annotations

import sys
from datetime import datetime, timedelta
from pathlib import Path

import h5py
import numpy as np
import pytest
from asammdf import MDF, Signal
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
