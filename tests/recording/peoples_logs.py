"""One run as the logs that people have: each in the writing of its logger, with what is right to ask of it.

None is written by the library that reads them.
"""

from __future__ import annotations

import csv
import datetime as dt
import io
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from example_run import COUNT, PERIOD, RUN
from numpy.typing import NDArray
from scipy.io import savemat

Write = Callable[[Path], None]
BAR = {"reference": "gauge", "unit": "bar"}
GAUGE = 1e-5 * RUN.pressure_a, 1e-5 * RUN.pressure_b
MILLIMETRES = 1e3 * RUN.position
START = dt.datetime(2026, 11, 26, 21, 4, 52)


@dataclass(frozen=True)
class Log:
    """A log: its file's name, what writes it, and by channel the answer to each question that is right to ask.

    `lost` says that rows are missing in the file, so that values are only compared at their own times.
    """

    name: str
    write: Write
    answers: dict[str, dict[str, Any] | None] = field(default_factory=dict)
    lost: bool = False


def cells(values: Sequence[float] | NDArray[Any], form: str = "{:.9g}") -> list[str]:
    return [form.format(value) for value in values]


def text(
    heads: Sequence[str], columns: Sequence[Sequence[str]], delimiter: str = ",", above: str = "", quote: bool = False
) -> Write:
    """What writes rows of cells below a row of names, and lines above it."""

    def write(path: Path) -> None:
        out = io.StringIO()
        out.write(above)
        how = csv.QUOTE_ALL if quote else csv.QUOTE_MINIMAL
        writer = csv.writer(out, delimiter=delimiter, quoting=how, lineterminator="\r\n")
        if heads:
            writer.writerow(heads)
        writer.writerows(zip(*columns, strict=True))
        path.write_bytes(out.getvalue().encode("utf-8"))

    return write


TIMES = [k * PERIOD for k in range(COUNT)]
U, X, PA, PB = cells(RUN.voltage), cells(MILLIMETRES), cells(GAUGE[0]), cells(GAUGE[1])
REST = ["u [V]", "x [mm]", "pA [bar]", "pB [bar]"]


def timed(head: str, times: Sequence[str], **how: Any) -> Write:
    """The usual columns behind a column of times."""
    return text([head, *REST], [times, U, X, PA, PB], **how)


def stamped(form: str, start: dt.datetime = START, milliseconds: bool = True) -> list[str]:
    """Dates in a form of strftime; %L are milliseconds."""
    found = []
    for k in range(COUNT):
        instant = start + dt.timedelta(milliseconds=k)
        made = instant.strftime(form.replace("%L", f"{instant.microsecond // 1000:03d}"))
        found.append(made)
    return found


def commas(column: Sequence[str]) -> list[str]:
    return [cell.replace(".", ",") for cell in column]


def grouped(values: NDArray[Any], point: str = ".", group: str = ",", digits: int = 3) -> list[str]:
    swap = str.maketrans({",": group, ".": point})
    return [f"{value:,.{digits}f}".translate(swap) for value in values]


def suffixed(values: Sequence[float] | NDArray[Any]) -> list[str]:
    """Numbers with a letter for their power of ten, as plots of instruments export them."""
    found = []
    for value in values:
        for size, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n")):
            if abs(value) >= size or (size == 1e-9):
                found.append(f"{value / size:.7g}{letter}")
                break
    return found


def twincat(path: Path) -> None:
    """A Scope's export: a column of times for each signal, of its own rate."""
    names = ["fValveVoltage_V", "fPiston_mm", "fPressureA_bar", "fPressureB_bar"]
    lines = [
        "Name\tScope Project",
        "File\tRig.csv",
        "Starttime of export\t134087426922340000\tDonnerstag\t21:04:52",
        "",
        "\t".join(f"Name\t{name}" for name in names),
        "\t".join(f"SampleTime[ms]\t{k}" for k in (1, 2, 1, 5)),
        "\t".join(f"Unit\t{unit}" for unit in ("V", "mm", "bar", "bar")),
        "",
    ]
    series = [(list(range(0, COUNT, k)), column[::k]) for k, column in ((1, U), (2, X), (1, PA), (5, PB))]
    for k in range(COUNT):
        row = [
            part for times, column in series for part in ((str(times[k]), column[k]) if k < len(times) else ("", ""))
        ]
        lines.append("\t".join(commas(row)))
    path.write_text("\n".join([*lines, "EOF"]) + "\n")


def one_timeline(path: Path) -> None:
    """The same on one time: cells of slower signals stay empty between their samples."""
    lines = ["\t".join(["Time [ms]", *REST])]
    for k in range(COUNT):
        row = [str(k), U[k], X[k] if k % 2 == 0 else "", PA[k], PB[k] if k % 5 == 0 else ""]
        lines.append("\t".join(commas(row)))
    path.write_text("\n".join(lines) + "\n")


def side_by_side(path: Path) -> None:
    """Two tables in one sheet, the second recorded at half the rate, an empty column between them."""
    lines = ["Time [s],u [V],x [mm],,Time [s],pA [bar],pB [bar]"]
    for k in range(COUNT):
        right = [f"{2 * TIMES[k]:.4f}", PA[2 * k], PB[2 * k]] if 2 * k < COUNT else ["", "", ""]
        lines.append(",".join([f"{TIMES[k]:.4f}", U[k], X[k], "", *right]))
    path.write_text("\n".join(lines) + "\n")


def two_rates(path: Path) -> None:
    """Two tables in one with times of other names, below a spreadsheet's line on its separator."""
    lines = ["sep=;", "t_fast [s];u [V];x [mm];t_slow [s];pA [bar];pB [bar]"]
    for k in range(COUNT):
        slow = [f"{2 * TIMES[k]:.4f}", PA[2 * k], PB[2 * k]] if 2 * k < COUNT else ["", "", ""]
        lines.append(";".join([f"{TIMES[k]:.4f}", U[k], X[k], *slow]))
    path.write_text("\n".join(lines) + "\n")


def control_desk(path: Path) -> None:
    names = [
        "Command/Valve_V",
        "Cylinder position/Pos_mm",
        "Cylinder pressure(bar)/HeadSide_P",
        "Cylinder pressure(bar)/RodSide_P",
    ]
    head = [
        "descriptions,General,User,",
        "",
        f"trace_size,{COUNT}",
        "trace_types,5,4,4,4,4",
        "trace_names,,Volts,In1,In1,In1",
        "trace_units,,,,,",
        "devices,Platform,Platform,Platform,Platform,Platform",
        "raster,1ms,1ms,1ms,1ms,1ms",
        f"path,,{','.join(f'Model Root/{name}' for name in names)}",
        "trace_values",
    ]
    rows = [f",{TIMES[k]:.6f},{U[k]},{X[k]},{PA[k]},{PB[k]}" for k in range(COUNT)]
    path.write_text("\n".join([*head, *rows]) + "\n")


def influx(path: Path) -> None:
    head = ["#group,false,false,true,true,false,false,true,true", "#default,mean,,,,,,,"]
    lines = [*head, ",result,table,_start,_stop,_time,_value,_field,_measurement"]
    series = {
        "voltage_command": RUN.voltage,
        "position": RUN.position,
        "pressure_a": RUN.pressure_a + 101325.0,
        "pressure_b": RUN.pressure_b + 101325.0,
    }
    for table, (name, values) in enumerate(series.items()):
        for stamp, value in zip(stamped("%Y-%m-%dT%H:%M:%S.%L000000Z"), values, strict=True):
            lines.append(f",,{table},2026-11-26T21:00:00Z,2026-11-26T21:10:00Z,{stamp},{float(value)!r},{name},rig")
    path.write_text("\n".join(lines) + "\n")


def historian(path: Path) -> None:
    """Values as they change, a unit on each row, tags with their rig in front, in the order of time."""
    lines = ["TagName;Timestamp;Value;Unit"]
    named = {
        "RIG1.VALVE_VOLTAGE": ("V", U),
        "RIG1.STROKE": ("mm", X),
        "RIG1.PRESSURE_A": ("bar", PA),
        "RIG1.PRESSURE_B": ("bar", PB),
    }
    for k, stamp in enumerate(stamped("%d.%m.%Y %H:%M:%S,%L")):
        lines += [f"{tag};{stamp};{column[k].replace('.', ',')};{unit}" for tag, (unit, column) in named.items()]
    path.write_text("\n".join(lines) + "\n")


def json_lines(names: Sequence[str], nested: bool = False) -> Write:
    def write(path: Path) -> None:
        lines = []
        for k in range(COUNT):
            row = dict(zip(names, (TIMES[k], RUN.voltage[k], MILLIMETRES[k], GAUGE[0][k], GAUGE[1][k]), strict=True))
            lines.append(json.dumps({"time_s": row.pop(names[0]), "data": row} if nested else row))
        path.write_text("\n".join(lines) + "\n")

    return write


def matrix(names: Sequence[str] | None) -> Write:
    def write(path: Path) -> None:
        content: dict[str, Any] = {"X": np.stack([RUN.voltage, MILLIMETRES, *GAUGE], axis=1), "Tout": np.array(TIMES)}
        if names:
            content["names"] = np.array(list(names), dtype=object)
        savemat(path, content)

    return write


def mat_of_rates(path: Path) -> None:
    """Structures with times of their own, as Simulink logs signals of several rates."""
    fast, slow = np.array(TIMES), np.array(TIMES[::2])
    savemat(
        path,
        {
            "fast": {"time": fast, "valve_V": RUN.voltage, "pA_bar": GAUGE[0]},
            "slow": {"time": slow, "stroke_mm": MILLIMETRES[::2], "pB_bar": GAUGE[1][::2]},
        },
    )
