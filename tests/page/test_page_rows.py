"""What is said on the page becomes the topics file that the same answers make on a terminal."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eha_core.errors import EhaError
from eha_core.page.rows import Row, row_of, rule_of_row
from eha_core.page.session import Session
from eha_core.recording import read_recording
from eha_core.recording.channel_rules import ChannelRule

sys.path.append(str(Path(__file__).resolve().parent.parent / "recording"))

from example_run import CHANNELS, TIME
from logs_asked import ASKED
from logs_read import AS_THEY_ARE

LOGS = AS_THEY_ARE | ASKED
SOME = (
    "controldesk", "twincat_all_timelines", "influx", "mat_of_two_rates", "rate_in_the_header",
    "day_numbers_of_excel", *ASKED,
)  # fmt: skip


def opened(tmp_path: Path, kind: str) -> tuple[Session, dict[str, Any], Path]:
    path = tmp_path / LOGS[kind].name
    LOGS[kind].write(path)
    session = Session(tmp_path / "out")
    session.open(path)
    return session, session.state()["file"], path


def answered(file: dict[str, Any], kind: str) -> tuple[list[dict[str, Any]], list[str]]:
    """The rows with each question answered as is right for a log, as a person does with the mouse."""
    rows, without = list(file["rows"]), []
    for question in file["questions"]:
        right = LOGS[kind].answers[question["channel"]]
        if right is None:
            without.append(question["channel"])
            continue
        names = [column["name"] for column in file["columns"]]
        column = names.index(right["column"]) if "column" in right else -1
        minus = names.index(right["minus"]) if "minus" in right else None
        row = next(
            answer["row"] for answer in question["answers"]
            if answer is not None and answer["row"]["column"] == column and answer["row"]["minus"] == minus
            and answer["row"]["unit"] in ("", right.get("unit", answer["row"]["unit"]))
            and answer["row"]["reference"] in ("", right.get("reference", answer["row"]["reference"]))
            and answer["row"]["counts"] == ("rate" in right)
        )  # fmt: skip
        rows.append(row | {key: right[key] for key in ("points", "rate") if key in right})
    return rows, without


@pytest.mark.parametrize("kind", SOME)
def test_a_log_is_read_as_it_was_said_to_be(tmp_path: Path, kind: str) -> None:
    session, file, path = opened(tmp_path, kind)
    text = session.say(*answered(file, kind))
    (topics,) = (tmp_path / "out").glob("*/topics.yaml")
    assert topics.read_text() == text
    channels = read_recording(path, topics).channels
    assert set(channels) == set(CHANNELS)
    for name, expected in CHANNELS.items():
        factor = 0.1 if kind == "low_pressures" and "pressure" in name else 1.0
        there = np.interp(channels[name].time, TIME, factor * expected)
        tolerance = 100.0 if "pressure" in name else 1e-6
        np.testing.assert_allclose(channels[name].values, there, rtol=2e-6, atol=tolerance)


@pytest.mark.parametrize("kind", ["percent_counts", "no_time", "two_positions"])
def test_an_open_question_is_no_topics_file(tmp_path: Path, kind: str) -> None:
    session, file, _ = opened(tmp_path, kind)
    with pytest.raises(EhaError, match="still open: ") as caught:
        session.say(file["rows"], [])
    assert file["questions"][0]["text"] in str(caught.value)
    with pytest.raises(EhaError, match="say what the columns are first"):
        session.diagnose()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"points": [[4, 0], [20, None]]}, "position: say what 20 as recorded means in mm"),
        ({"points": [[4, 0], [4, 1]]}, "two values for one number"),
        ({"unit": "bar"}, "bar is not a unit of it"),
        ({"column": 99}, "the file has no such column"),
        ({"column": -7}, "the file has no such column"),
        ({"channel": "pressure_a"}, "two columns are said to be it"),
        ({"channel": "speed"}, "'speed' is no channel"),
        ({"points": "many"}, "load the page again"),
    ],
)
def test_a_row_that_cannot_be_is_refused_in_one_line(tmp_path: Path, change: dict[str, Any], message: str) -> None:
    session, file, _ = opened(tmp_path, "controldesk")
    rows = [row | change if row["channel"] == "position" else row for row in file["rows"]]
    with pytest.raises(EhaError, match=message) as caught:
        session.say(rows, [])
    assert "\n" not in str(caught.value)


def test_a_turned_sign_reads_the_other_way_round(tmp_path: Path) -> None:
    session, file, path = opened(tmp_path, "controldesk")
    rows = [row | {"turned": row["channel"] == "position"} for row in file["rows"]]
    session.say(rows, [])
    (topics,) = (tmp_path / "out").glob("*/topics.yaml")
    position = read_recording(path, topics).channels["position"]
    np.testing.assert_allclose(position.values, -CHANNELS["position"], atol=1e-8)
    session.open(topics)
    assert [row["turned"] for row in session.state()["file"]["rows"] if row["channel"] == "position"] == [True]


def test_a_topics_file_of_another_time_is_what_the_page_shows(tmp_path: Path) -> None:
    session, file, path = opened(tmp_path, "loop_currents")
    rows, without = answered(file, "loop_currents")
    session.say(rows, without)
    (topics,) = (tmp_path / "out").glob("*/topics.yaml")
    again = Session(tmp_path / "again")
    again.open(path)
    again.open(topics)
    shown = again.state()["file"]["rows"]
    key = {row["channel"]: row | {"points": [list(pair) for pair in row["points"]]} for row in rows}
    assert {row["channel"]: row | {"points": [list(pair) for pair in row["points"]]} for row in shown} == key
    assert again.say(shown, []) == topics.read_text()


@pytest.mark.parametrize(
    "rule",
    [
        ChannelRule(column="x [mm]", unit="mm"),
        ChannelRule(column="x [mm]", unit="mm", points=((4.0, 0.0), (20.0, 100.0))),
        ChannelRule(column="x [mm]", unit="mm", minus="u [V]"),
        ChannelRule(column="x [mm]", points=((0.0, 0.0), (1.0, -1.0))),
    ],
)
def test_a_rule_becomes_a_row_and_the_rule_again(tmp_path: Path, rule: ChannelRule) -> None:
    from eha_core.recording.inspection import inspect_file

    path = tmp_path / "a.csv"
    path.write_text("t [s],u [V],x [mm]\n" + "".join(f"{k / 1000},{k % 7},{k % 11}\n" for k in range(100)))
    inspection = inspect_file(path)
    row = row_of("position", rule, inspection)
    assert row is not None and rule_of_row(row, inspection.fields) == rule
    turned = rule_of_row(replace(row, turned=not row.turned), inspection.fields)
    raw = np.linspace(-3.0, 30.0, 9)
    np.testing.assert_allclose(turned.in_si(raw), -rule.in_si(raw))


def test_a_factor_of_a_topics_file_becomes_two_points(tmp_path: Path) -> None:
    from eha_core.recording.inspection import inspect_file

    path = tmp_path / "a.csv"
    path.write_text("t [s],u [V],x\n" + "".join(f"{k / 1000},{k % 7},{k % 11}\n" for k in range(100)))
    inspection = inspect_file(path)
    rule = ChannelRule(column="x", scale=-2e-3, offset=0.25)
    row = row_of("position", rule, inspection)
    assert row == Row(2, "position", points=((0.0, 0.25), (1.0, 0.248)))
    raw = np.linspace(-3.0, 30.0, 9)
    np.testing.assert_allclose(rule_of_row(row, inspection.fields).in_si(raw), rule.in_si(raw))
