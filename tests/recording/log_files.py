"""One run of a rig as ten kinds of log file, each written by other means than it is read by."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow
import pyarrow.parquet
from numpy.typing import NDArray
from scipy.io import savemat

COUNT, PERIOD = 400, 1e-3
EPOCH_MS = 1_726_000_000_000
ATMOSPHERE = 101325.0

TIME = np.arange(COUNT) * PERIOD
VOLTAGE = 0.05 * np.sin(2.0 * np.pi * 5.0 * TIME)
POSITION = 0.02 * (1.0 - np.cos(2.0 * np.pi * 5.0 * TIME))
PRESSURE_A = 8e6 + 2e6 * np.cos(2.0 * np.pi * 5.0 * TIME)
PRESSURE_B = 9e6 - 2e6 * np.cos(2.0 * np.pi * 5.0 * TIME)
"""V, m, and gauge Pa."""
CHANNELS = {"voltage_command": VOLTAGE, "position": POSITION, "pressure_a": PRESSURE_A, "pressure_b": PRESSURE_B}

Columns = dict[str, NDArray[Any]]
IN_BAR: Columns = {
    "u [V]": VOLTAGE,
    "x [mm]": POSITION * 1e3,
    "pA [bar]": PRESSURE_A / 1e5,
    "pB [bar]": PRESSURE_B / 1e5,
}


def rows(columns: Sequence[NDArray[Any]], delimiter: str, decimal: str = ".", digits: int = 9) -> str:
    """The columns as lines of text, whole numbers as they are."""
    lines = []
    for row in zip(*columns, strict=True):
        cells = [str(cell) if isinstance(cell, str | int) else f"{cell:.{digits}g}" for cell in row]
        lines.append(delimiter.join(cells).replace(".", decimal))
    return "\n".join(lines) + "\n"


def semicolons(path: Path) -> None:
    """Spreadsheet of a German system: ; and decimal comma, names with units, time in ms, Windows' code page."""
    names = "Zeit [ms];" + ";".join(IN_BAR) + ";Öltemperatur [°C]\n"
    columns = [TIME * 1e3, *IN_BAR.values(), np.full(COUNT, 41.5)]
    path.write_bytes((names + rows(columns, ";", ",")).encode("cp1252"))


def tabs(path: Path) -> None:
    """Tabs, a row of units under the names, time since 1970 in ms."""
    names = "stamp\tu_valve\tx_piston\tp_head\tp_rod\nms\tV\tmm\tbar\tbar\n"
    stamps = [EPOCH_MS + k for k in range(COUNT)]
    path.write_text(names + rows([np.array(stamps, dtype=object), *IN_BAR.values()], "\t"))


def dates(path: Path) -> None:
    """Commas and dates in ISO form with a zone."""
    stamps = [f"2024-09-10T22:26:{40 + k // 1000:02d}.{k % 1000:03d}+02:00" for k in range(COUNT)]
    path.write_text(
        "timestamp,u_V,x_mm,pA_bar,pB_bar\n" + rows([np.array(stamps, dtype=object), *IN_BAR.values()], ",")
    )


def labview(path: Path) -> None:
    """A LabVIEW measurement file: header, segment header, no column of x values."""
    per_channel = "\t".join
    header = [
        "LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab", "Decimal_Separator\t,",
        "Multi_Headings\tNo", "X_Columns\tNo", "Time_Pref\tRelative", "Operator\tlab", "Date\t2024/09/10",
        "Time\t22:26:40,0", "***End_of_Header***\t", "\t", "Channels\t4", "Samples\t" + per_channel([str(COUNT)] * 4),
        "Date\t" + per_channel(["2024/09/10"] * 4), "Time\t" + per_channel(["22:26:40,0"] * 4),
        "Y_Unit_Label\tV\tmm\tbar\tbar", "X_Dimension\t" + per_channel(["Time"] * 4),
        "X0\t" + per_channel(["0,0000000000000000E+0"] * 4), "Delta_X\t" + per_channel(["0,001000"] * 4),
        "***End_of_Header***\t", "X_Value\tvalve\tpiston position\tpressure A\tpressure B\tComment",
    ]  # fmt: skip
    body = "".join(f"\t{line}\n" for line in rows(list(IN_BAR.values()), "\t", ",").splitlines())
    path.write_text("\n".join(header) + "\n" + body)


def control_desk(path: Path) -> None:
    """A ControlDesk recorder's file: labelled rows, then values under a first column of labels."""
    names = ["Time", "u", "x", "pA", "pB"]
    lines = ["file_type,recording", "", "trace_names," + ",".join(names), "path,," + ",".join(["Model Root/IO"] * 4)]
    lines.append("unit,s,V,mm,bar,bar")
    body = rows([TIME, *IN_BAR.values()], ",").splitlines()
    lines += [f"{'' if k else 'trace_values'},{line}" for k, line in enumerate(body)]
    path.write_text("\n".join(lines) + "\n")


def without_names(path: Path) -> None:
    """Blanks between numbers and nothing above them."""
    path.write_text(rows([TIME, *IN_BAR.values()], "   "))


def mat_5(path: Path) -> None:
    """A recorder's structure in a MAT file of version 5: X.Data, and Y(k).Name, .Data, .Unit."""
    signals = [
        {"Name": name.split()[0], "Data": values, "Unit": name.split("[")[1][:-1]} for name, values in IN_BAR.items()
    ]
    kind = [("Name", object), ("Data", object), ("Unit", object)]
    y = np.array([(one["Name"], one["Data"], one["Unit"]) for one in signals], dtype=kind)
    savemat(
        path,
        {"run1": {"X": {"Name": "Time", "Data": TIME, "Unit": "s"}, "Y": y}, "operator": "lab"},
        do_compression=True,
    )


def mat_73(path: Path) -> None:
    """Vectors in a MAT file of version 7.3, as MATLAB lays them out: 1 x n, with its classes as attributes."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in {
            "t": TIME,
            "u_V": VOLTAGE,
            "x_mm": POSITION * 1e3,
            "p_A_Pa": PRESSURE_A,
            "p_B_Pa": PRESSURE_B,
        }.items():
            file.create_dataset(name, data=values.reshape(-1, 1)).attrs["MATLAB_class"] = np.bytes_("double")
        text = file.create_dataset("operator", data=np.array([[108], [97], [98]], dtype=np.uint16))
        text.attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + b"\0" * 8 + b"\x00\x02IM")


def parquet(path: Path) -> None:
    """A Parquet file with instants and single precision."""
    instants = (EPOCH_MS * 1_000_000 + np.arange(COUNT) * 1_000_000).astype("datetime64[ns]")
    columns: dict[str, Any] = {"timestamp": instants, "voltage_command": VOLTAGE, "position": POSITION}
    columns |= {"pressure_a": (PRESSURE_A + ATMOSPHERE).astype(np.float32), "pressure_b": PRESSURE_B + ATMOSPHERE}
    columns["mode"] = ["auto"] * COUNT
    pyarrow.parquet.write_table(pyarrow.table(columns), path)


TABLES: dict[str, tuple[str, Callable[[Path], None], str]] = {
    "semicolons": ("run.csv", semicolons, """
time: {column: "Zeit [ms]", unit: ms}
voltage_command: {column: "u [V]"}
position: {column: "x [mm]", unit: mm}
pressure_a: {column: "pA [bar]", unit: bar, reference: gauge}
pressure_b: {column: "pB [bar]", unit: bar, reference: gauge}"""),
    "tabs": ("run.tsv", tabs, """
time: {column: stamp}
voltage_command: {column: u_valve}
position: {column: x_piston, unit: mm}
pressure_a: {column: p_head, unit: barg}
pressure_b: {column: p_rod, unit: barg}"""),
    "dates": ("run.txt", dates, """
time: {column: timestamp}
voltage_command: {column: u_V}
position: {column: x_mm, unit: mm}
pressure_a: {column: pA_bar, unit: barg}
pressure_b: {column: pB_bar, unit: barg}"""),
    "labview": ("run.lvm", labview, """
time: {column: X_Value}
voltage_command: {column: valve}
position: {column: piston position, unit: mm}
pressure_a: {column: pressure A, unit: barg}
pressure_b: {column: pressure B, unit: barg}"""),
    "control_desk": ("rec.csv", control_desk, """
time: {column: Time}
voltage_command: {column: u}
position: {column: x, unit: mm}
pressure_a: {column: pA, unit: barg}
pressure_b: {column: pB, unit: barg}"""),
    "without_names": ("plain.txt", without_names, """
time: {column: column 1}
voltage_command: {column: column 2}
position: {column: column 3, unit: mm}
pressure_a: {column: column 4, unit: barg}
pressure_b: {column: column 5, unit: barg}"""),
    "mat_5": ("run.mat", mat_5, """
time: {column: run1.X.Time}
voltage_command: {column: run1.Y.u}
position: {column: run1.Y.x, unit: mm}
pressure_a: {column: run1.Y.pA, unit: barg}
pressure_b: {column: run1.Y.pB, unit: barg}"""),
    "mat_73": ("run73.mat", mat_73, """
time: {column: t}
voltage_command: {column: u_V}
position: {column: x_mm, unit: mm}
pressure_a: {column: p_A_Pa, reference: gauge}
pressure_b: {column: p_B_Pa, reference: gauge}"""),
    "parquet": ("run.parquet", parquet, """
time: {column: timestamp}"""),
}  # fmt: skip
"""Each kind: the file's name, what writes it, and the channels of a topics file that reads it."""
