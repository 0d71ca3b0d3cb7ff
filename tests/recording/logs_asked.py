"""Logs of which something is asked, with the answers."""

from __future__ import annotations

import datetime as dt
from typing import Any

import numpy as np
from example_run import COUNT, RUN, TIME
from numpy.typing import NDArray
from peoples_logs import (
    BAR,
    GAUGE,
    MILLIMETRES,
    PA,
    PB,
    REST,
    TIMES,
    Log,
    U,
    X,
    cells,
    json_lines,
    matrix,
    stamped,
    text,
    timed,
)  # fmt: skip

PERCENT = {"points": [[0, 0], [100, 10]], "unit": "V"}
NAMES = (("u", "V"), ("x", "mm"), ("pA", "bar"), ("pB", "bar"))
RATE = {"rate": 1000}
UP, DOWN = np.maximum(RUN.voltage, 0.0) * 10.0, np.maximum(-RUN.voltage, 0.0) * 10.0
LOOPS = {
    "pressure_a": {"points": [[4, 0], [20, 250]], "unit": "bar", "reference": "gauge"},
    "pressure_b": {"points": [[4, 0], [20, 250]], "unit": "bar", "reference": "gauge"},
}


def loop(values: NDArray[Any], full: float) -> list[str]:
    return cells(4.0 + 16.0 * values / full)


ASKED: dict[str, Log] = {
    "matrix_without_names": Log(
        "a.mat",
        matrix(None),
        {
            "voltage_command": {"column": "X[0]", "unit": "V"},
            "position": {"column": "X[1]", "unit": "mm"},
            "pressure_a": {"column": "X[2]", **BAR},
            "pressure_b": {"column": "X[3]", **BAR},
        },
    ),
    "names_ending_in_a_and_b": Log(
        "a.csv",
        text(
            ["t", "EXP_Command", "EXP_Position", "EXP_Pressure_A", "EXP_Pressure_B"],
            [cells(TIMES), U, cells(RUN.position), cells(RUN.pressure_a), cells(RUN.pressure_b)],
        ),
        {
            "voltage_command": {"column": "EXP_Command", "unit": "V"},
            "position": {"column": "EXP_Position", "unit": "m"},
        },
    ),
    "one_sided_duty_and_angle": Log(
        "a.csv",
        text(
            [
                "time [s]",
                "Arm_up_duty [%]",
                "Arm_down_duty [%]",
                "Arm angle [deg]",
                "Head pressure [bar]",
                "Rod pressure [bar]",
            ],
            [cells(TIMES), cells(UP), cells(DOWN), cells(RUN.position * 1e3 / 5.0), PA, PB],
        ),
        {
            "voltage_command": {"column": "Arm_up_duty [%]", "minus": "Arm_down_duty [%]", **PERCENT},
            "position": {"column": "Arm angle [deg]", "points": [[0, 0], [10, 50]], "unit": "mm"},
        },
    ),
    "one_sided_currents": Log(
        "a.csv",
        text(
            ["time [s]", "Extend valve [%]", "Retract valve [%]", "stroke [mm]", "pA [bar]", "pB [bar]"],
            [cells(TIMES), cells(UP), cells(DOWN), X, PA, PB],
        ),
        {"voltage_command": {"column": "Extend valve [%]", "minus": "Retract valve [%]", **PERCENT}},
    ),
    "sample_index": Log(
        "a.csv", timed("sample", [str(k) for k in range(COUNT)]), {"time": {"column": "sample", "rate": 1000}}
    ),
    "sample_index_of_a_spreadsheet": Log(
        "a.csv", timed("#", [str(k + 1) for k in range(COUNT)]), {"time": {"column": "#", "rate": 1000}}
    ),
    "no_time": Log("a.csv", text(REST, [U, X, PA, PB]), {"time": {"rate": 1000}}),
    "time_by_whole_numbers": Log(
        "a.csv", timed("t", [str(k) for k in range(COUNT)]), {"time": {"column": "t", "unit": "ms"}}
    ),
    "time_faster_than_any_rig": Log(
        "a.csv", timed("Time [ms]", cells(TIMES)), {"time": {"column": "Time [ms]", "unit": "s"}}
    ),
    "clock_in_whole_seconds": Log(
        "a.csv",
        text(["Time", *REST], [[f"21:04:5{2 + k // 100}" for k in range(COUNT)], U, X, PA, PB]),
        {"time": {"column": "Time", "rate": 1000}},
    ),
    "clock_of_half_the_rate": Log(
        "a.csv",
        timed("Time", [f"21:04:52.{2 * (k // 2):03d}" for k in range(COUNT)]),
        {"time": {"column": "Time", "rate": 1000}},
    ),
    "dates_over_midnight_day_or_month_first": Log(
        "a.csv",
        timed("Time", stamped("%d/%m/%Y %H:%M:%S.%L", dt.datetime(2026, 5, 4, 23, 59, 59, 800_000))),
        {"time": {"column": "Time", "day_first": True}},
    ),
    "dates_of_the_us_over_midnight_beside_clocks": Log(
        "a.csv",
        text(
            ["Date", "Time", *REST],
            [
                stamped("%m/%d/%Y", dt.datetime(2026, 4, 5, 23, 59, 59, 800_000)),
                stamped("%H:%M:%S.%L", dt.datetime(2026, 4, 5, 23, 59, 59, 800_000)),
                U,
                X,
                PA,
                PB,
            ],
        ),
        {"time": {"column": "Time", "day_first": False}},
    ),
    "percent": Log(
        "a.csv",
        text(
            ["t [s]", "valve_pct", "x [mm]", "pA [bar]", "pB [bar]"],
            [cells(TIMES), cells(RUN.voltage * 10.0), X, PA, PB],
        ),
        {"voltage_command": {"column": "valve_pct", **PERCENT}},
    ),
    "per_mille": Log(
        "a.csv",
        text(
            ["t [s]", "valve [\u2030]", "x [cm]", "pA [kgf/cm2]", "pB [kgf/cm2]"],
            [
                cells(TIMES),
                cells(RUN.voltage * 100.0),
                cells(RUN.position * 1e2),
                *(cells(values / 98_066.5) for values in (RUN.pressure_a, RUN.pressure_b)),
            ],
        ),
        {"voltage_command": {"column": "valve [\u2030]", "points": [[0, 0], [1000, 10]], "unit": "V"}},
    ),
    "percent_counts": Log(
        "a.csv",
        text(
            ["t [s]", "valve [%]", "x [counts]", "pA [bar]", "pB [bar]"],
            [cells(TIMES), cells(RUN.voltage * 10.0), cells(RUN.position * 1e6), PA, PB],
        ),
        {
            "voltage_command": {"column": "valve [%]", **PERCENT},
            "position": {"column": "x [counts]", "points": [[0, 0], [1000, 1]], "unit": "mm"},
        },
    ),
    "loop_currents": Log(
        "a.csv",
        text(
            ["t [s]", "u [V]", "x [mA]", "pA [mA]", "pB [mA]"],
            [cells(TIMES), U, loop(MILLIMETRES, 100.0), loop(GAUGE[0], 250.0), loop(GAUGE[1], 250.0)],
        ),
        {
            "position": {"column": "x [mA]", "points": [[4, 0], [20, 100]], "unit": "mm"},
            "pressure_a": {"column": "pA [mA]", **LOOPS["pressure_a"]},
            "pressure_b": {"column": "pB [mA]", **LOOPS["pressure_b"]},
        },
    ),
    "one_loop_current": Log(
        "a.csv",
        text(
            ["t [s]", "u [V]", "x [mm]", "pA [mA]", "pB [bar]"],
            [cells(TIMES), U, X, loop(GAUGE[0], 250.0), PB],
            ";",
        ),
        {"pressure_a": {"column": "pA [mA]", **LOOPS["pressure_a"]}},
    ),
    "two_cylinders": Log(
        "a.csv",
        text(
            ["t [s]", *(f"{name}{k} [{unit}]" for k in (1, 2) for name, unit in NAMES)],
            [cells(TIMES), U, X, PA, PB, cells(-RUN.voltage), cells(5.0 + MILLIMETRES), PB, PA],
        ),
        {
            "voltage_command": {"column": "u1 [V]", "unit": "V"},
            "position": {"column": "x1 [mm]", "unit": "mm"},
            "pressure_a": {"column": "pA1 [bar]", **BAR},
            "pressure_b": {"column": "pB1 [bar]", **BAR},
        },
    ),
    "ports_by_their_letters": Log(
        "a.csv",
        text(
            ["time", "valve_cmd_V", "pos_mm", "P_bar", "T_bar", "A_bar", "B_bar"],
            [cells(TIMES), U, X, cells(210.0 + RUN.voltage), cells(2.0 + 0.01 * RUN.voltage), PA, PB],
        ),
        {"supply_pressure": None},
    ),
    "inputs_of_a_card": Log(
        "a.csv",
        text(
            ["Time [ms]", *(f"Channel {letter} [V]" for letter in "ABCD")],
            [cells(1e3 * TIME), U, cells(MILLIMETRES / 10.0), cells(GAUGE[0] / 25.0), cells(GAUGE[1] / 25.0)],
        ),
        {
            "voltage_command": {"column": "Channel A [V]", "unit": "V"},
            "position": {"column": "Channel B [V]", "points": [[0, 0], [10, 100]], "unit": "mm"},
            "pressure_a": {"column": "Channel C [V]", "points": [[0, 0], [10, 250]], **BAR},
            "pressure_b": {"column": "Channel D [V]", "points": [[0, 0], [10, 250]], **BAR},
        },
    ),
    "valve_in_a_loop": Log(
        "a.csv",
        text(
            ["t [s]", "valve [mA]", "x [mm]", "pA [bar]", "pB [bar]"],
            [cells(TIMES), cells(12.0 + 0.8 * RUN.voltage), X, PA, PB],
        ),
        {"voltage_command": {"column": "valve [mA]", "points": [[4, -10], [20, 10]], "unit": "V"}},
    ),
    "sensors_in_volts": Log(
        "a.csv",
        text(
            ["t [s]", "valve cmd [V]", "LVDT [V]", "Pressure_A [V]", "Pressure_B [V]"],
            [cells(TIMES), U, cells(MILLIMETRES / 10.0), cells(GAUGE[0] / 25.0), cells(GAUGE[1] / 25.0)],
        ),
        {
            "position": {"column": "LVDT [V]", "points": [[0, 0], [10, 100]], "unit": "mm"},
            **{
                f"pressure_{side}": {
                    "column": f"Pressure_{side.upper()} [V]",
                    "points": [[0, 0], [10, 250]],
                    "unit": "bar",
                    "reference": "gauge",
                }
                for side in "ab"
            },
        },
    ),
    "json_without_units": Log(
        "a.jsonl",
        json_lines(["t", "u", "x", "pA", "pB"]),
        {
            "voltage_command": {"column": "u", "unit": "V"},
            "position": {"column": "x", "unit": "mm"},
            "pressure_a": {"column": "pA", **BAR},
            "pressure_b": {"column": "pB", **BAR},
        },
    ),
    "a_unit_that_is_none": Log(
        "a.csv",
        text(["t [s]", "u [V]", "stroke [Skt]", "pA [bar]", "pB [bar]"], [cells(TIMES), U, X, PA, PB]),
        {"position": {"column": "stroke [Skt]", "unit": "mm"}},
    ),
    "two_positions": Log(
        "a.csv",
        text(
            ["t [s]", "u [V]", "stroke [mm]", "laser [mm]", "pA [bar]", "pB [bar]"],
            [cells(TIMES), U, X, cells(MILLIMETRES + 2.0), PA, PB],
        ),
        {"position": {"column": "stroke [mm]", "unit": "mm"}},
    ),
    "low_pressures": Log(
        "a.csv",
        text(
            ["t [s]", "u [V]", "x [mm]", "pA [bar]", "pB [bar]"],
            [cells(TIMES), U, X, cells(GAUGE[0] / 10.0), cells(GAUGE[1] / 10.0)],
        ),
        {"pressure_a": {"column": "pA [bar]", **BAR}, "pressure_b": {"column": "pB [bar]", **BAR}},
    ),
}
"""Logs of which something is asked, with the answers."""
