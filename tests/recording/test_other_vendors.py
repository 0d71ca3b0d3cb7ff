"""Headers of other vendors and rigs: what of them is certain, what is asked, and what is neither."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from example_run import COUNT, RUN, TIME
from peoples_logs import GAUGE, MILLIMETRES, cells, text

from eha_core.recording.inspection import inspect_file
from eha_core.recording.suggestions import suggest

VALUES = {
    "t": TIME,
    "u": RUN.voltage,
    "x": MILLIMETRES,
    "pA": GAUGE[0],
    "pB": GAUGE[1],
    "pS": 210.0 + RUN.voltage,
    "pT": 2.0 + RUN.voltage,
    "%": 10.0 * RUN.voltage,
    "n": 1500.0 + RUN.voltage,
    "Pa": RUN.pressure_a,
    "0": 0.0 * TIME + 7.0,
}

HEADERS: dict[str, tuple[list[tuple[str, str]], dict[str, str], set[str]]] = {
    "catman": (
        [
            ("Zeit  1 - Standardmessrate [s]", "t"),
            ("Weg_Zylinder [mm]", "x"),
            ("Druck_A [bar]", "pA"),
            ("Druck_B [bar]", "pB"),
            ("Ventil_Soll [V]", "u"),
        ],
        {"position": "Weg_Zylinder [mm]", "pressure_a": "Druck_A [bar]", "pressure_b": "Druck_B [bar]"},
        {"voltage_command"},  # what is wanted of a valve is its command, which somebody has to say
    ),
    "dewesoft": (
        [
            ("Time (s)", "t"),
            ("Valve/AVE (V)", "u"),
            ("Stroke/AVE (mm)", "x"),
            ("pA/AVE (bar)", "pA"),
            ("pB/AVE (bar)", "pB"),
        ],
        {
            "voltage_command": "Valve/AVE (V)",
            "position": "Stroke/AVE (mm)",
            "pressure_a": "pA/AVE (bar)",
            "pressure_b": "pB/AVE (bar)",
        },
        set(),
    ),
    "drive": (
        [
            ("Time [s]", "t"),
            ("S-0-0051 Position feedback value [mm]", "x"),
            ("P-0-2000 Chamber pressure A [bar]", "pA"),
            ("P-0-2001 Chamber pressure B [bar]", "pB"),
        ],
        {
            "position": "S-0-0051 Position feedback value [mm]",
            "pressure_a": "P-0-2000 Chamber pressure A [bar]",
            "pressure_b": "P-0-2001 Chamber pressure B [bar]",
        },
        set(),
    ),
    "two_cylinders": (
        [
            ("t [s]", "t"),
            ("Cyl1 Position [mm]", "x"),
            ("Cyl2 Position [mm]", "x"),
            ("Cyl1 pA [bar]", "pA"),
            ("Cyl1 pB [bar]", "pB"),
            ("Cyl2 pA [bar]", "pB"),
            ("Cyl2 pB [bar]", "pA"),
        ],
        {},
        {"position", "pressure_a", "pressure_b"},
    ),
    "pump_and_tank": (
        [
            ("t [s]", "t"),
            ("pP [bar]", "pS"),
            ("pT [bar]", "pT"),
            ("pA [bar]", "pA"),
            ("pB [bar]", "pB"),
            ("x [mm]", "x"),
        ],
        {"supply_pressure": "pP [bar]", "pressure_a": "pA [bar]", "pressure_b": "pB [bar]", "position": "x [mm]"},
        set(),
    ),
    "numbered_pressures": (
        [("t(s)", "t"), ("P1(bar)", "pA"), ("P2(bar)", "pB"), ("P3(bar)", "pS")],
        {"pressure_a": "P1(bar)", "pressure_b": "P2(bar)"},
        {"supply_pressure"},
    ),
    "wrong_units": (
        [("time [s]", "t"), ("u [V]", "u"), ("x [m]", "x"), ("pA [Pa]", "pA")],
        {"voltage_command": "u [V]"},
        {"position", "pressure_a"},  # 40 m of stroke, and 100 Pa
    ),
    "flows_and_pump": (
        [("t [s]", "t"), ("QA [l/min]", "%"), ("QB [l/min]", "%"), ("n [1/min]", "n"), ("v [mm/s]", "x")],
        {"flow_a": "QA [l/min]", "flow_b": "QB [l/min]", "pump_speed": "n [1/min]", "velocity": "v [mm/s]"},
        set(),
    ),
    "what_is_wanted": (
        [
            ("t [s]", "t"),
            ("reference [mm]", "x"),
            ("error [mm]", "x"),
            ("position command [mm]", "x"),
            ("position [mm]", "x"),
        ],
        {"position": "position [mm]"},
        set(),
    ),
    "series_of_a_data_base": (
        [("Time [s]", "t"), ('pressure_a_bar{rig="1"}', "pA"), ('pressure_b_bar{rig="2"}', "pB")],
        {},
        {"pressure_a", "pressure_b"},
    ),
    "an_index_without_a_name": (
        [("", "index"), ("u [V]", "u"), ("x [mm]", "x")],
        {"voltage_command": "u [V]", "position": "x [mm]"},
        {"time"},
    ),
    "german_words_in_one": (
        [
            ("Zeit in s", "t"),
            ("Ventilspannung in V", "u"),
            ("Kolbenweg in mm", "x"),
            ("Druck Kolbenseite in bar", "pA"),
            ("Stangendruck in bar", "pB"),
            ("Pumpendruck in bar", "pS"),
            ("Tankdruck in bar", "pT"),
        ],
        {
            "voltage_command": "Ventilspannung in V",
            "position": "Kolbenweg in mm",
            "pressure_a": "Druck Kolbenseite in bar",
            "pressure_b": "Stangendruck in bar",
            "supply_pressure": "Pumpendruck in bar",
        },
        set(),
    ),
    "other_parts": (
        [
            ("t [s]", "t"),
            ("Motor current [A]", "u"),
            ("Supply voltage [V]", "0"),
            ("Pilot pressure [bar]", "pS"),
            ("delta p [bar]", "pS"),
            ("Tank pressure [bar]", "pT"),
            ("Oil temp [°C]", "x"),
            ("Acceleration [m/s^2]", "u"),
        ],
        {},
        set(),
    ),
}
"""Columns and what they hold; what is certain of them, by channel; which channels are asked after."""


@pytest.mark.parametrize("vendor", list(HEADERS))
def test_a_header_is_read_as_far_as_it_tells(tmp_path: Path, vendor: str) -> None:
    columns, certain, asked = HEADERS[vendor]
    path = tmp_path / "run.csv"
    values = {**VALUES, "index": np.arange(COUNT)}
    text([name for name, _ in columns], [cells(values[kind]) for _, kind in columns], ";")(path)
    found = suggest(inspect_file(path))
    assert {one.channel: one.field.path for one in found.certain if one.channel != "time"} == certain
    assert {question.channel for question in found.questions} == asked


def test_a_rate_that_contradicts_the_times_makes_a_question_of_them(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    columns = [[str(k) for k in range(COUNT)], cells(RUN.voltage), cells(MILLIMETRES)]
    text(["Time [ms]", "u [V]", "x [mm]"], columns, above="Sample rate: 500 Hz\n")(path)
    (question,) = suggest(inspect_file(path)).questions
    assert question.channel == "time" and question.text.endswith("; the file states 500 Hz")


@pytest.mark.parametrize("minus", ["-", "\u2212"])
@pytest.mark.parametrize("power", ["e", "E", "D", "d"])
def test_signs_and_powers_of_other_systems_are_numbers(tmp_path: Path, minus: str, power: str) -> None:
    path = tmp_path / "run.csv"
    column = [f"{value:.9e}".replace("e", power).replace("-", minus) for value in RUN.voltage]
    text(["t [s]", "u [V]"], [cells(TIME), column])(path)
    inspection = inspect_file(path)
    assert inspection.remarks == () and inspection.fields[1].count == COUNT
    assert inspection.fields[1].low == pytest.approx(float(RUN.voltage.min()))
