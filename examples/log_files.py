"""One run of a rig as every kind of log file that `eha inspect` and `eha diagnose` read.

python examples/log_files.py bags/rig_coulomb_friction.mcap out/logs
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow
import pyarrow.parquet
from numpy.typing import NDArray
from scipy.io import savemat

from eha_core.errors import EhaError
from eha_core.recording import read_recording

EPOCH_MS = 1_726_000_000_000
"""2024-09-10 20:26:40 UTC, when the runs begin."""
ATMOSPHERE = 101325.0
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """What a rig's instruments gave: s, V, m and gauge Pa, at even steps."""

    time: Array
    voltage: Array
    position: Array
    pressure_a: Array
    pressure_b: Array

    @property
    def logged(self) -> list[Array]:
        """V, mm, bar and bar, as loggers write them."""
        return [self.voltage, self.position * 1e3, self.pressure_a / 1e5, self.pressure_b / 1e5]

    @property
    def milliseconds(self) -> list[int]:
        """Whole ms since the beginning."""
        return [round(time * 1e3) for time in self.time.tolist()]


def rows(columns: Sequence[Sequence[Any] | NDArray[Any]], delimiter: str, decimal: str = ".") -> list[str]:
    """The columns as lines of text; what is no float is written as it is."""
    lines = []
    for row in zip(*columns, strict=True):
        cells = [f"{cell:.9g}" if isinstance(cell, float) else str(cell) for cell in row]
        lines.append(delimiter.join(cells).replace(".", decimal))
    return lines


def semicolons(path: Path, run: Run) -> None:
    """Spreadsheet of a German system: ; and decimal comma, names with units, time in ms, Windows' code page."""
    names = "Zeit [ms];u [V];x [mm];pA [bar];pB [bar];Öltemperatur [°C]"
    columns = [run.milliseconds, *run.logged, [41.5] * len(run.time)]
    path.write_bytes("\n".join([names, *rows(columns, ";", ","), ""]).encode("cp1252"))


def tabs(path: Path, run: Run) -> None:
    """Tabs, a row of units under the names, time in ms since 1970."""
    head = ["stamp\tu_valve\tx_piston\tp_head\tp_rod", "ms\tV\tmm\tbar\tbar"]
    stamps = [EPOCH_MS + time for time in run.milliseconds]
    path.write_text("\n".join([*head, *rows([stamps, *run.logged], "\t"), ""]))


def dates(path: Path, run: Run) -> None:
    """Commas and dates in ISO form with a zone."""
    start = np.datetime64(EPOCH_MS + 2 * 3_600_000, "ms")
    stamps = [f"{start + np.timedelta64(time, 'ms')}+02:00" for time in run.milliseconds]
    path.write_text("\n".join(["timestamp,u_V,x_mm,pA_bar,pB_bar", *rows([stamps, *run.logged], ","), ""]))


def labview(path: Path, run: Run) -> None:
    """A LabVIEW measurement file: header, segment header, no column of x values."""
    step = f"{run.time[1] - run.time[0]:.6f}".replace(".", ",")

    def four(value: str) -> str:
        return "\t".join([value] * 4)

    head = [
        "LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab", "Decimal_Separator\t,",
        "Multi_Headings\tNo", "X_Columns\tNo", "Time_Pref\tRelative", "Operator\tlab", "Date\t2024/09/10",
        "Time\t22:26:40,0", "***End_of_Header***\t", "\t", "Channels\t4", f"Samples\t{four(str(len(run.time)))}",
        f"Date\t{four('2024/09/10')}", f"Time\t{four('22:26:40,0')}", "Y_Unit_Label\tV\tmm\tbar\tbar",
        f"X_Dimension\t{four('Time')}", f"X0\t{four('0,0000000000000000E+0')}", f"Delta_X\t{four(step)}",
        "***End_of_Header***\t", "X_Value\tvalve\tpiston position\tpressure A\tpressure B\tComment",
    ]  # fmt: skip
    path.write_text("\n".join([*head, *(f"\t{line}" for line in rows(run.logged, "\t", ",")), ""]))


def control_desk(path: Path, run: Run) -> None:
    """A ControlDesk recorder's file: labelled rows, then values beside a first column of labels."""
    head = ["file_type,recording", "", "trace_names,Time,u,x,pA,pB", f"path,,{','.join(['Model Root/IO'] * 4)}"]
    body = [f"{'' if k else 'trace_values'},{line}" for k, line in enumerate(rows([run.time, *run.logged], ","))]
    path.write_text("\n".join([*head, "unit,s,V,mm,bar,bar", *body, ""]))


def without_names(path: Path, run: Run) -> None:
    """Blanks between numbers and nothing above them."""
    path.write_text("\n".join([*rows([run.time, *run.logged], "   "), ""]))


def mat_5(path: Path, run: Run) -> None:
    """A recorder's structure in a MAT file of version 5: X.Data, and Y(k).Name, .Data, .Unit."""
    kind = [("Name", object), ("Data", object), ("Unit", object)]
    named = zip(("u", "x", "pA", "pB"), run.logged, ("V", "mm", "bar", "bar"), strict=True)
    x = {"Name": "Time", "Data": run.time, "Unit": "s"}
    savemat(path, {"run1": {"X": x, "Y": np.array(list(named), dtype=kind)}, "operator": "lab"}, do_compression=True)


def mat_73(path: Path, run: Run) -> None:
    """Vectors in a MAT file of version 7.3, as MATLAB lays them out: HDF5 behind its own 512 bytes."""
    millimetres = run.position * 1e3
    vectors = {
        "t": run.time,
        "u_V": run.voltage,
        "x_mm": millimetres,
        "p_A_Pa": run.pressure_a,
        "p_B_Pa": run.pressure_b,
    }
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in vectors.items():
            file.create_dataset(name, data=values.reshape(-1, 1)).attrs["MATLAB_class"] = np.bytes_("double")
        text = file.create_dataset("operator", data=np.array([[108], [97], [98]], dtype=np.uint16))
        text.attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + b"\0" * 8 + b"\x00\x02IM")


def parquet(path: Path, run: Run) -> None:
    """A Parquet file with instants, single precision, absolute pressures and a column of words."""
    instants = (EPOCH_MS + np.array(run.milliseconds)).astype("datetime64[ms]")
    columns: dict[str, Any] = {"timestamp": instants, "voltage_command": run.voltage, "position": run.position}
    columns["pressure_a"] = (run.pressure_a + ATMOSPHERE).astype(np.float32)
    columns["pressure_b"] = run.pressure_b + ATMOSPHERE
    pyarrow.parquet.write_table(pyarrow.table({**columns, "mode": ["auto"] * len(run.time)}), path)


KINDS: dict[str, tuple[str, Callable[[Path, Run], None]]] = {
    "semicolons": ("rig.csv", semicolons), "tabs": ("rig.tsv", tabs), "dates": ("rig_dates.csv", dates),
    "labview": ("rig.lvm", labview), "control_desk": ("rig_controldesk.csv", control_desk),
    "without_names": ("rig.txt", without_names), "mat_5": ("rig.mat", mat_5), "mat_73": ("rig_73.mat", mat_73),
    "parquet": ("rig.parquet", parquet),
}  # fmt: skip
"""Each kind's file name and what writes it."""


def main() -> int:
    """Write the run of a recording as every kind of file."""
    if len(sys.argv) != 3:
        print("usage: python examples/log_files.py RECORDING FOLDER", file=sys.stderr)
        return 2
    try:
        table = read_recording(sys.argv[1]).to_dict()
    except EhaError as error:
        print(f"log_files: {error}", file=sys.stderr)
        return 1
    run = Run(*(table[name] for name in ("time", "voltage_command", "position", "pressure_a", "pressure_b")))
    folder = Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for name, write in KINDS.values():
        write(folder / name, run)
        print(folder / name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
