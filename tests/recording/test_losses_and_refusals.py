"""What a table loses is counted and quoted, or refused; what is no table is refused by what it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from example_run import COUNT, RUN, TIME
from peoples_logs import PA, PB, TIMES, U, X, cells, grouped, text

from eha_core.cli import main
from eha_core.errors import RecordingError
from eha_core.recording import read_recording
from eha_core.recording.inspection import inspect_file
from eha_core.recording.suggestions import suggest
from eha_core.tables import read_table

HEADS = ["time", "position", "pressure_a"]


def of_positions(folder: Path, position: list[str], pressure: list[str] | None = None, delimiter: str = ",") -> Path:
    path = folder / "run.csv"
    pressure = pressure or cells(RUN.pressure_a)
    text(HEADS, [cells(TIMES), position, pressure], delimiter)(path)
    return path


def test_empty_and_unreadable_cells_are_counted_apart_and_the_first_is_quoted(tmp_path: Path) -> None:
    position = cells(RUN.position)
    position[7:10] = ["", "", ""]
    position[20], position[30] = "ERR", "bad"
    path = of_positions(tmp_path, position)
    loss = read_table(path).losses["position"]
    assert (loss.empty, loss.unreadable, loss.first, loss.row, loss.by_value) == (3, 2, "ERR", 21, False)
    said = "3 cells are empty and 2 cells could not be read, the first 'ERR' in row 21"
    assert f"'position': {said}" in inspect_file(path).remarks
    recording = read_recording(path)
    assert f"position (position): {said}" in recording.remarks
    assert len(recording.channels["position"].values) == COUNT - 5
    assert len(recording.channels["pressure_a"].values) == COUNT


@pytest.mark.parametrize("mark", ["####", "OVER", "", "nan"])
def test_a_channel_that_loses_its_largest_values_is_refused(tmp_path: Path, mark: str) -> None:
    position = [mark if value > 0.035 else f"{value:.9g}" for value in RUN.position]
    path = of_positions(tmp_path, position)
    with pytest.raises(RecordingError, match="all where it is largest or smallest; the rest is not a fair sample"):
        read_recording(path)
    inspection = inspect_file(path)
    assert [field.path for field in inspection.fields if field.problem] == ["position"]
    assert "position" not in {reading.channel for reading in suggest(inspection).certain}


def test_gaps_that_lie_anywhere_are_no_loss_by_value(tmp_path: Path) -> None:
    position = cells(RUN.position)
    for k in range(0, COUNT, 7):
        position[k] = ""
    assert not read_table(of_positions(tmp_path, position)).losses["position"].by_value


def test_numbers_of_two_writings_in_one_column_are_refused(tmp_path: Path) -> None:
    pressure = [f"{value:.1f}" if k % 3 else f"{value:.1f}".replace(".", ",") for k, value in enumerate(RUN.pressure_a)]
    path = of_positions(tmp_path, cells(RUN.position), pressure, ";")
    with pytest.raises(RecordingError, match="'pressure_a' has 134 numbers that are written another way than the rest"):
        read_recording(path)


def test_thousands_that_appear_late_are_read(tmp_path: Path) -> None:
    """The first rows are below a thousand, so nothing there tells how thousands are written."""
    values = np.linspace(900.0, 1100.0, COUNT)
    path = of_positions(tmp_path, cells(RUN.position), grouped(values, digits=3))
    np.testing.assert_allclose(read_table(path).columns["pressure_a"], values, atol=1e-3)


@pytest.mark.parametrize(("delimiter", "mark"), [(";", ","), ("\t", ",")])
def test_a_mark_that_may_be_a_point_or_thousands_is_refused(tmp_path: Path, delimiter: str, mark: str) -> None:
    path = tmp_path / "run.csv"
    column = [f"{10_000 + 3 * k:,}".replace(",", mark) for k in range(COUNT)]
    text(["time", "p"], [[str(k) for k in range(COUNT)], column], delimiter)(path)
    with pytest.raises(
        RecordingError, match=r"'10,000' may be 10\.000 or 10000, and no number of the file tells which"
    ):
        read_table(path)


def test_decimal_commas_between_commas_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    lines = ["t,u,x"] + [f"{k // 1000},{k % 1000:03d},0,5,1,{k}" for k in range(40)]
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(RecordingError, match="its decimal commas divide the cells too"):
        read_table(path)


def test_a_second_table_below_the_first_is_left_out_and_said(tmp_path: Path) -> None:
    path = of_positions(tmp_path, cells(RUN.position))
    path.write_text(path.read_text() + "time,velocity,pressure_b\n" + "1.0,2.0,3.0\n" * 50)
    table = read_table(path)
    assert len(table.columns["position"]) == COUNT
    assert table.remarks == (f"a second table, from row {COUNT + 1} on, was left out",)


def test_a_header_that_repeats_in_the_middle_is_passed_over(tmp_path: Path) -> None:
    path = of_positions(tmp_path, cells(RUN.position))
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:200], lines[0], *lines[200:]]) + "\n")
    table = read_table(path)
    assert len(table.columns["position"]) == COUNT and table.losses == {} and table.remarks == ()


def test_columns_of_words_are_named_and_no_loss_of_numbers(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    text(["time", "mode", "position", "note"], [cells(TIMES), ["auto"] * COUNT, cells(RUN.position), [""] * COUNT])(
        path
    )
    assert inspect_file(path).remarks == ("without numbers: mode, note",)


def test_rows_without_a_time_are_counted(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    text(HEADS[:2], [["" if k % 100 == 50 else f"{k * 1e-3}" for k in range(COUNT)], cells(RUN.position)])(path)
    recording = read_recording(path)
    assert "4 rows without a time in 'time' were left out" in recording.remarks
    assert len(recording.channels["position"].values) == COUNT - 4


ASC = """date Thu Nov 26 09:04:52.000 pm 2026
base hex  timestamps absolute
   0.000000 1  101             Rx   d 4 D5 26 00 00
"""
OTHERS = {
    "can.asc": (ASC.encode(), "a Vector CAN log (ASC) of raw frames"),
    "can.blf": (b"LOGG" + b"\0" * 200, "a Vector CAN log (BLF) of raw frames"),
    "can.trc": (
        b";$FILEVERSION=1.1\n;$STARTTIME=46352.8\n 1) 0.1 Rx 0101 4 D5 26 00 00\n",
        "a PCAN trace of raw frames",
    ),
    "can.log": (b"(1795727092.000000) can0 101#D5260000\n" * 9, "a candump log of raw frames"),
    "kvaser.csv": (b"Time,Channel,CAN ID,DLC,D1,D2\n0.1,1,101,2,D5,26\n" * 9, "a log of raw CAN frames"),
    "run.bag": (b"#ROSBAG V2.0\n" + b"\0" * 99, "a bag of ROS 1"),
    "run.xls": (b"\xd0\xcf\x11\xe0" + b"\0" * 99, "an old workbook (.xls)"),
    "run.csv.gz": (b"\x1f\x8b\x08" + b"\0" * 99, "a packed file (gzip)"),
    "run.html": (b"<!DOCTYPE html><table><tr><td>1</td></tr></table>", "markup (XML or HTML)"),
    "run.bin": (bytes(range(256)) * 4, "of no kind that is known here"),
}


@pytest.mark.parametrize("name", list(OTHERS))
def test_what_holds_no_columns_is_refused_by_what_it_is(
    tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    content, what = OTHERS[name]
    path = tmp_path / name
    path.write_bytes(content)
    assert main(["inspect", str(path)]) == 2
    said = capsys.readouterr().err
    assert f"is {what}" in said and said.count("\n") == 1 and ".mcap, .db3 and rosbag2 folders" in said


def test_a_file_without_any_channel_is_unusable(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, topics = tmp_path / "run.csv", tmp_path / "topics.yaml"
    text(["time [s]", "mass [kg]", "Oil temperature [°C]"], [cells(TIMES), U, X])(path)
    assert main(["inspect", str(path), "--topics", str(topics)]) == 2
    assert "holds nothing that can be a channel" in capsys.readouterr().err
    assert not topics.exists()


def test_a_file_of_an_unknown_ending_is_read_as_the_text_that_it_is(tmp_path: Path) -> None:
    path = tmp_path / "run.xyz"
    text(HEADS, [cells(TIMES), cells(RUN.position), cells(RUN.pressure_a)], "|")(path)
    np.testing.assert_allclose(read_recording(path).channels["position"].values, RUN.position, atol=1e-9)
    np.testing.assert_allclose(read_recording(path).channels["position"].time, TIME, atol=1e-9)


def test_pressures_of_both_sides_are_not_swapped_by_the_order_of_columns(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    text(["t [s]", "p_rod [bar]", "u [V]", "p_cap [bar]", "x [mm]"], [cells(TIMES), PB, U, PA, X])(path)
    found = {one.channel: one.field.path for one in suggest(inspect_file(path)).certain}
    assert (found["pressure_a"], found["pressure_b"]) == ("p_cap [bar]", "p_rod [bar]")
