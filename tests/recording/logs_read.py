"""Logs that are read without a question."""

from __future__ import annotations

import datetime as dt

from example_run import COUNT, RUN
from peoples_logs import (
    GAUGE,
    MILLIMETRES,
    PA,
    PB,
    REST,
    START,
    TIMES,
    Log,
    U,
    X,
    cells,
    commas,
    control_desk,
    grouped,
    historian,
    influx,
    json_lines,
    mat_of_rates,
    matrix,
    one_timeline,
    side_by_side,
    stamped,
    suffixed,
    text,
    timed,
    twincat,
    two_rates,
)

AS_THEY_ARE: dict[str, Log] = {
    "controldesk": Log("a.csv", control_desk),
    "matrix_with_names": Log("a.mat", matrix(["valve V", "stroke mm", "pA bar", "pB bar"])),
    "mat_of_two_rates": Log("a.mat", mat_of_rates, lost=True),
    "si_suffixes": Log(
        "a.csv",
        text(
            [
                "Time (s) - Plot 0",
                "Command (V) - Plot 0",
                "Position (m) - Plot 0",
                "Pressure A (Pa) - Plot 1",
                "Pressure B (Pa) - Plot 1",
            ],
            [suffixed(column) for column in (TIMES, RUN.voltage, RUN.position, RUN.pressure_a, RUN.pressure_b)],
        ),
    ),
    "interval_in_the_header": Log(
        "a.txt",
        text(
            ["Sample Number", "Date/Time", "valve [V]", "stroke [mm]", "pA [bar]", "pB [bar]"],
            [[str(k) for k in range(COUNT)], stamped("%m/%d/%Y %I:%M:%S.%L %p"), U, X, PA, PB],
            above="Device: logger\nSampling Interval: 0.001\nChannels: 4\n\n",
        ),
    ),
    "twincat_all_timelines": Log("a.csv", twincat, lost=True),
    "twincat_one_timeline": Log("a.csv", one_timeline, lost=True),
    "twincat_filetime": Log(
        "a.csv", timed("Time", [str(134087426922340000 + 10_000 * k) for k in range(COUNT)], delimiter="\t")
    ),
    "two_tables_beside": Log("a.csv", side_by_side, lost=True),
    "two_tables_of_other_names": Log("a.csv", two_rates, lost=True),
    "thousands": Log(
        "a.csv",
        text(
            ["time [s]", "u [V]", "x [mm]", "pA [kPa]", "pB [kPa]"],
            [cells(TIMES), U, X, grouped(1e2 * GAUGE[0], digits=6), grouped(1e2 * GAUGE[1], digits=6)],
        ),
    ),
    "thousands_of_switzerland": Log(
        "a.csv",
        text(
            ["time [s]", "u [V]", "x [mm]", "pA [kPa]", "pB [kPa]"],
            [
                cells(TIMES),
                U,
                X,
                grouped(1e2 * GAUGE[0], group="'", digits=6),
                grouped(1e2 * GAUGE[1], group="'", digits=6),
            ],
            ";",
        ),
    ),
    "thousands_of_germany": Log(
        "a.csv",
        text(
            ["Zeit [s]", "Ventilspannung [V]", "Weg [mm]", "Druck Kolbenseite [kPa]", "Druck Stangenseite [kPa]"],
            [
                commas(cells(TIMES)),
                commas(U),
                commas(X),
                grouped(1e2 * GAUGE[0], ",", ".", 6),
                grouped(1e2 * GAUGE[1], ",", ".", 6),
            ],
            ";",
        ),
    ),
    "quoted_decimal_commas": Log(
        "a.csv", text(["Zeit [s]", *REST], [commas(c) for c in (cells(TIMES), U, X, PA, PB)], quote=True)
    ),
    "dates_of_the_us": Log("a.csv", timed("Time", stamped("%m/%d/%Y %I:%M:%S.%L %p"))),
    "dates_of_the_us_early": Log(
        "a.csv", timed("Time", stamped("%m/%d/%Y %I:%M:%S.%L %p", START.replace(month=4, day=5)))
    ),
    "dates_with_month_names": Log("a.csv", timed("Date", stamped("%d-%b-%Y %H:%M:%S.%L"))),
    "date_and_clock_apart": Log(
        "a.csv", text(["Date", "Time", *REST], [stamped("%d.%m.%Y"), commas(stamped("%H:%M:%S.%L")), U, X, PA, PB], ";")
    ),
    "milliseconds_apart": Log(
        "a.csv",
        text(["Time", "Millisec", *REST], [stamped("%H:%M:%S"), [str(k % 1000) for k in range(COUNT)], U, X, PA, PB]),
    ),
    "clock_with_colon_before_ms": Log("a.csv", timed("Time", stamped("%H:%M:%S:%L"))),
    "minutes_and_seconds": Log("a.csv", timed("Time", stamped("%M:%S.%L"))),
    "day_numbers_of_excel": Log(
        "a.csv", timed("Time", [f"{46352.87837962963 + k * 1e-3 / 86400:.12f}" for k in range(COUNT)])
    ),
    "day_numbers_of_matlab": Log(
        "a.csv", timed("Time", [f"{739947.87837962963 + k * 1e-3 / 86400:.12f}" for k in range(COUNT)])
    ),
    "over_midnight": Log("a.csv", timed("Time", stamped("%H:%M:%S.%L", dt.datetime(2026, 1, 1, 23, 59, 59, 800_000)))),
    "twelve_hours_without_am": Log(
        "a.csv", timed("Time", stamped("%I:%M:%S.%L", dt.datetime(2026, 1, 1, 12, 59, 59, 800_000)))
    ),
    "counter_of_16_bits": Log("a.csv", timed("Time [ms]", [str((65_400 + k) % 65_536) for k in range(COUNT)])),
    "counter_of_32_bits": Log(
        "a.csv", timed("t_us", [str((2**32 - 150_000 + 1000 * k) % 2**32) for k in range(COUNT)])
    ),
    "epoch_in_ms": Log("a.csv", timed("timestamp", [str(1_795_727_092_000 + k) for k in range(COUNT)])),
    "gps_seconds": Log("a.csv", timed("gps_time", [f"{1_479_700_000 + k * 1e-3:.3f}" for k in range(COUNT)])),
    "dot_net_ticks": Log(
        "a.csv", timed("Timestamp", [str(639_000_000_000_000_000 + 10_000 * k) for k in range(COUNT)])
    ),
    "rate_in_the_header": Log("a.csv", text(REST, [U, X, PA, PB], above="Sample rate: 1000 Hz\nChannels: 4\n")),
    "rate_in_khz": Log("a.csv", text(REST, [U, X, PA, PB], ";", above="Abtastrate [kHz];1\n")),
    "interval_in_ms": Log(
        "a.csv",
        text(["No.", *REST], [[str(k + 1) for k in range(COUNT)], U, X, PA, PB], above="Sampling interval,1,ms\n\n"),
    ),
    "influx": Log("a.csv", influx),
    "historian": Log("a.csv", historian),
    "json_with_units": Log("a.jsonl", json_lines(["t_s", "valve_V", "stroke_mm", "pA_bar", "pB_bar"])),
    "json_nested": Log("a.ndjson", json_lines(["t_s", "valve_V", "stroke_mm", "p_head_bar", "p_rod_bar"], nested=True)),
    "units_below_the_names": Log(
        "a.dat",
        text(
            ["Running Time", "Valve Command", "Stroke", "Head Pressure", "Rod Pressure"],
            [["Sec", *cells(TIMES)], ["V", *U], ["mm", *X], ["bar", *PA], ["bar", *PB]],
            "\t",
        ),
    ),
    "labels_units_and_types": Log(
        "a.csv",
        text(
            [],
            [
                ["Name", "Unit", "Type", *cells(TIMES)],
                ["uValve", "V", "LREAL", *U],
                ["xPiston", "mm", "LREAL", *X],
                ["pHead", "bar", "LREAL", *PA],
                ["pRod", "bar", "LREAL", *PB],
            ],
            ";",
        ),
    ),
    "units_in_words": Log(
        "a.csv",
        text(
            ["Time, s", "Valve in V", "Position, mm", "Pressure A, bar", "Pressure B, bar"],
            [cells(TIMES), U, X, PA, PB],
            "\t",
        ),
    ),
    "units_in_the_cells": Log(
        "a.csv",
        text(
            ["Time", "Valve voltage", "Stroke", "Pressure A", "Pressure B"],
            [
                cells(TIMES, "{:.4f} s"),
                cells(RUN.voltage, "{:.9f} V"),
                cells(MILLIMETRES, "{:.9f} mm"),
                cells(GAUGE[0], "{:.8f} bar"),
                cells(GAUGE[1], "{:.8f} bar"),
            ],
        ),
    ),
    "psi_and_inches": Log(
        "a.csv",
        text(
            [
                "Time (s)",
                "Servo Command (V)",
                "Actuator Position (in)",
                "Cap End Pressure (psi)",
                "Rod End Pressure (psi)",
            ],
            [
                cells(TIMES),
                U,
                cells(RUN.position / 0.0254),
                cells(RUN.pressure_a / 6894.757293168),
                cells(RUN.pressure_b / 6894.757293168),
            ],
        ),
    ),
    "references_in_the_names": Log(
        "a.csv",
        text(
            ["t_s", "u_V", "x_mm", "pA_kPa_abs", "pB_kPa_abs"],
            [cells(TIMES), U, X, *(cells(1e2 * values + 101.325) for values in GAUGE)],
        ),
    ),
    "ends_of_a_cylinder": Log(
        "a.csv",
        text(
            ["Elapsed Time (sec)", "Cmd (volts)", "Stroke (inches)", "Blind End PSIG", "Rod End PSIG"],
            [
                cells(TIMES),
                U,
                cells(RUN.position / 0.0254),
                cells(RUN.pressure_a / 6894.757293168),
                cells(RUN.pressure_b / 6894.757293168),
            ],
        ),
    ),
    "oil_that_warms": Log(
        "a.csv",
        text(
            ["time", "u_V", "x_mm", "T_oil", "pA_bar", "pB_bar"],
            [cells(TIMES), U, X, [f"{41.0 + 0.1 * (k // 50):.1f}" for k in range(COUNT)], PA, PB],
        ),
    ),
    "french": Log(
        "a.csv",
        text(
            ["Temps [s]", "Tension vanne [V]", "Course [mm]", "Pression A [bar]", "Pression B [bar]"],
            [commas(cells(TIMES)), commas(U), commas(X), commas(PA), commas(PB)],
            ";",
        ),
    ),
    "hungarian_names_in_structures": Log(
        "a.csv",
        text(
            [
                "Time [s]",
                "GVL_Rig.stAxis.fValveVoltage [V]",
                "GVL_Rig.stAxis.fActPos [mm]",
                "GVL_Rig.stAxis.fPressA [bar]",
                "GVL_Rig.stAxis.fPressB [bar]",
            ],
            [cells(TIMES), U, X, PA, PB],
        ),
    ),
    "names_that_repeat_in_levels": Log(
        "a.csv",
        text(
            [
                "Group1/Time [s]",
                "Group1/AI0 Valve Command [V]",
                "Group1/AI1 Piston Position [mm]",
                "Group1/AI2 Pressure Port A [bar]",
                "Group1/AI3 Pressure Port B [bar]",
            ],
            [cells(TIMES), U, X, PA, PB],
        ),
    ),
    "further_columns": Log(
        "a.csv",
        text(
            [
                "Time [s]",
                "Tank temperature [°C]",
                "Position setpoint [mm]",
                "Position [mm]",
                "Valve [V]",
                "Pressure A [bar]",
                "Pressure B [bar]",
                "Tank pressure [bar]",
                "Motor current [A]",
                "Torque [Nm]",
            ],
            [
                cells(TIMES),
                ["41.5"] * COUNT,
                cells(MILLIMETRES + 1.0),
                X,
                U,
                PA,
                PB,
                cells(2.0 + 0.1 * RUN.voltage),
                cells(5.0 + RUN.voltage),
                cells(10.0 + RUN.voltage),
            ],
        ),
    ),
    "footer_and_trailing_delimiter": Log(
        "a.csv",
        text(
            ["t [s]", *REST, ""],
            [[*cells(TIMES), "end of file"], [*U, ""], [*X, ""], [*PA, ""], [*PB, ""], [""] * (COUNT + 1)],
            ";",
        ),
    ),
}
"""Logs that are read without a question."""
