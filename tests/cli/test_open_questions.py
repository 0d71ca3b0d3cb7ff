"""Questions as data: asked on a terminal, kept in the topics file, refused where open, assumed where wanted."""

from __future__ import annotations

import io
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import yaml

from eha_core.cli import main
from eha_core.errors import RecordingError
from eha_core.recording import load_topics_file, read_recording

FOLDER = Path(__file__).resolve().parent.parent / "recording"
sys.path.append(str(FOLDER))

from example_run import CHANNELS, RUN, TIME  # noqa: E402
from logs_asked import ASKED  # noqa: E402


def log(folder: Path, kind: str) -> Path:
    path = folder / ASKED[kind].name
    ASKED[kind].write(path)
    return path


def asked(path: Path, topics: Path, answers: list[str], monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{answer}\n" for answer in answers)))
    return main(["inspect", str(path), "--topics", str(topics), "--ask"])


DIALOGUES = {
    "loop_currents": ["", "0 bar", "250 bar", "1", "0", "25 MPa", "", "0 mm", "0.1 m"],
    "percent_counts": ["1", "1", "1 mm"],
    "sample_index": ["1", "1 kHz"],
    "json_without_units": ["1", "1", "1", "1"],
    "one_sided_duty_and_angle": ["1", "1", "0", "50"],
    "two_positions": ["1"],
}
"""What a person types at each question; Enter takes the first answer."""


@pytest.mark.parametrize("kind", list(DIALOGUES))
def test_answers_on_a_terminal_make_a_topics_file_that_reads_the_run(
    tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path, topics = log(tmp_path, kind), tmp_path / "topics.yaml"
    answers = DIALOGUES[kind]
    if kind == "one_sided_duty_and_angle":
        answers = ["1", "1", "0 mm", "50 mm"]
    assert asked(path, topics, answers, monkeypatch) == 0
    assert "4 channels certain, 0 questions" in capsys.readouterr().out
    channels = read_recording(path, topics).channels
    assert set(channels) == set(CHANNELS)
    for name, expected in CHANNELS.items():
        np.testing.assert_allclose(channels[name].values, expected, rtol=2e-6, atol=100.0 if "pres" in name else 1e-6)
        np.testing.assert_allclose(channels[name].time, TIME, atol=1e-6)


def test_a_wrong_answer_is_asked_again_and_the_end_of_answers_leaves_the_rest_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path, topics = log(tmp_path, "loop_currents"), tmp_path / "topics.yaml"
    assert asked(path, topics, ["9", "1", "many", "0 V", "0 bar", "250 bar"], monkeypatch) == 0
    said = capsys.readouterr()
    assert "'9' is not one of them" in said.err and "'many' is not a number with a unit of it" in said.err
    assert "2 questions" in said.out and "once they are answered" in said.out
    entries = yaml.safe_load(topics.read_text())["channels"]
    assert entries["pressure_a"]["points"] == [[4, 0], [20, 250]]
    assert {name for name, entry in entries.items() if "ask" in entry} == {"pressure_b", "position"}


def test_an_open_question_ends_a_diagnosis_in_the_first_second(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, topics = log(tmp_path, "percent"), tmp_path / "topics.yaml"
    main(["inspect", str(path), "--topics", str(topics)])
    capsys.readouterr()
    start = time.monotonic()
    assert main(["diagnose", str(path), "--topics", str(topics)]) == 2
    assert time.monotonic() - start < 1.0
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "voltage command [V] at 0 and at 100 pct (10 V at 100 % is usual)? it goes from -0.5 to 0.5" in said
    assert '{column: "valve_pct", points: [[0, 0], [100, 10]], unit: V} in place of its `ask`' in said
    assert "--assume takes the likely answers" in said


def test_what_is_assumed_is_listed_with_the_recording(tmp_path: Path) -> None:
    path, topics = log(tmp_path, "percent"), tmp_path / "topics.yaml"
    main(["inspect", str(path), "--topics", str(topics)])
    recording = read_recording(path, load_topics_file(topics, assume=True))
    np.testing.assert_allclose(recording.channels["voltage_command"].values, RUN.voltage, atol=1e-8)
    (remark,) = [one for one in recording.remarks if one.startswith("assumed: voltage_command")]
    assert remark.startswith(
        'assumed: voltage_command: {column: "valve_pct", points: [[0, 0], [100, 10]], unit: V} ("valve_pct":'
    )


def test_what_has_no_likely_answer_is_not_assumed(tmp_path: Path) -> None:
    path, topics = log(tmp_path, "loop_currents"), tmp_path / "topics.yaml"
    main(["inspect", str(path), "--topics", str(topics)])
    with pytest.raises(RecordingError, match="at 4 and at 20 mA") as caught:
        load_topics_file(topics, assume=True)
    assert "--assume" not in str(caught.value)


def test_columns_without_names_are_assumed_each_once(tmp_path: Path) -> None:
    path, topics = log(tmp_path, "matrix_without_names"), tmp_path / "topics.yaml"
    main(["inspect", str(path), "--topics", str(topics)])
    rules = load_topics_file(topics, assume=True).channels
    columns = [rule.column for rule in rules.values() if rule is not None]
    assert len(columns) == len(set(columns)) == 4


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("{column: x, points: [[4, 0]]}", "`points` needs pairs of what was recorded and what it means"),
        ("{column: x, points: [[4, 0], [4, 1]]}", "`points` has two values for one number"),
        ("{column: x, points: [[4, 1], [20, 1]]}", "`points` has one value for all numbers"),
        ("{column: x, points: [[4, 0], [20, null]]}", "`points` has no value at 20"),
        ("{column: x, points: [[4, 0], [20, many]]}", "points 'many' is not a number"),
        ("{minus: x}", "name that as `column` too"),
        ("{column: x, rate: 500}", "unknown key of position 'rate'"),
        ("{ask: maybe}", "`ask` needs a list of possible answers"),
        ("{ask: [{column: x}], unit: mm}", "unknown key of position 'unit'"),
    ],
)
def test_an_entry_that_says_nothing_is_refused_in_one_line(tmp_path: Path, entry: str, message: str) -> None:
    path = tmp_path / "topics.yaml"
    path.write_text(f"channels: {{position: {entry}}}")
    with pytest.raises(RecordingError, match=message) as caught:
        load_topics_file(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("rate", ["0", "-5", ".inf", "null", "fast"])
def test_a_rate_that_is_none_is_refused(tmp_path: Path, rate: str) -> None:
    path = tmp_path / "topics.yaml"
    path.write_text(f"channels: {{time: {{rate: {rate}}}}}")
    with pytest.raises(RecordingError, match="channel time"):
        load_topics_file(path)


def test_points_of_a_linkage_are_a_smooth_monotone_curve() -> None:
    """Against a crank whose stroke is known in closed form; beyond the points the curve goes on straight."""
    from eha_core.recording import ChannelRule

    def stroke(angle: np.ndarray) -> np.ndarray:
        return np.sqrt(0.5**2 + 0.2**2 + 2.0 * 0.5 * 0.2 * np.sin(np.radians(angle)))

    places = np.arange(-40.0, 41.0, 10.0)
    rule = ChannelRule(points=tuple((float(one), float(stroke(one))) for one in places))
    angles = np.linspace(-40.0, 40.0, 400)
    values = rule.in_si(angles)
    np.testing.assert_allclose(values, stroke(angles), atol=2e-4)
    assert np.all(np.diff(values) > 0.0)
    beyond = rule.in_si(np.array([50.0, 60.0]))
    assert beyond[1] - beyond[0] == pytest.approx(stroke(np.array(40.0)) - stroke(np.array(30.0)))


def test_what_was_taken_without_a_question_is_listed_with_the_recording(tmp_path: Path) -> None:
    path, topics = log(tmp_path, "percent"), tmp_path / "topics.yaml"
    main(["inspect", str(path), "--topics", str(topics)])
    entries = yaml.safe_load(topics.read_text())["channels"]
    assert entries["pressure_a"]["assumed"] == "gauge, for want of a word on it"
    recording = read_recording(path, load_topics_file(topics, assume=True))
    assert "assumed: pressure_a and pressure_b gauge, for want of a word on it" in recording.remarks
