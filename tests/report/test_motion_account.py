"""What is printed of a law of given motion, and shown on its page: certain, remains, next, each test, every remark."""

from __future__ import annotations

import json
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from eha_core.motion_given import Found, diagnose_motion
from eha_core.recording import Recording
from eha_core.report.document import as_json
from eha_core.report.motion_account import motion_account
from eha_core.report.motion_given import write_motion_given
from eha_core.report.motion_page import effect_table, error_table, motion_page

TIME = np.arange(4000) / 500.0


def recording(stretch: float, window: int = 1, name: str = "bench") -> Recording:
    """Position and force of a damper of 80 N and 900 N s/m: a motion of 0.8 and 1.7 Hz, scaled."""
    speed = stretch * (0.1 * np.cos(2.0 * np.pi * 0.8 * TIME) + 0.05 * np.cos(2.0 * np.pi * 1.7 * TIME))
    force = 80.0 * np.sign(speed) + 900.0 * speed + np.random.default_rng(1).standard_normal(len(TIME))
    force = np.convolve(force, np.ones(window) / window, "same")
    return Recording.from_arrays(
        time=TIME, position=np.cumsum(speed) / 500.0, velocity=speed, force=force, name=f"{name}.csv"
    )


@pytest.fixture(scope="module")
def found() -> Found:
    long = "the clock of the logger went back by a second, so that the samples after it were moved to where they belong"
    noted = [f"{long} ({place})" for place in range(4)]
    bench = replace(recording(1.0), remarks=tuple(noted))
    return diagnose_motion([bench], tests=[recording(-0.6, name="other"), recording(1.3, name="third")])


def test_it_begins_with_what_is_certain_then_what_remains_then_what_to_record(found: Found) -> None:
    labels = [line.split()[0] for line in motion_account(found).splitlines() if line[:1].strip()]
    assert labels == ["Recording", "Certain", "Remains", "Next", "Named", "Fitted", "Test", "Test", "Note"]
    said = " ".join(motion_account(found).split())
    assert "of dry friction opposes motion" in said
    assert "What remains, " in said and "is noise" in said


def test_each_test_has_its_error_in_newtons_and_of_its_deviation(found: Found) -> None:
    said = " ".join(motion_account(found).split())
    force = recording(-0.6).channels["force"].values
    for name in ("other.csv", "third.csv"):
        words = said.split(f"{name}: RMSE ")[1]
        error, share = float(words.split()[0]), float(words.split(" N, ")[1].split()[0])
        assert 0.9 < error < 6.0
        if name == "other.csv":
            assert share == pytest.approx(100.0 * error / np.std(force), abs=0.11)


def test_the_document_has_each_test(found: Found) -> None:
    document = json.loads(as_json(found.diagnosis))
    assert [test["path"] for test in document["tests"]] == ["other.csv", "third.csv"]
    for test in document["tests"]:
        errors = {model: one["force"]["free_running"] for model, one in test["prediction"].items()}
        assert errors["augmented"] < 0.1 * errors["nominal"]
    assert document["fit"]["held_out"]["force"]["rmse_after"] < 6.0


def test_every_remark_is_shown_as_a_whole(found: Found) -> None:
    said = " ".join(motion_account(found).split())
    assert found.diagnosis.remarks
    assert all(remark in said for remark in found.diagnosis.remarks)
    assert "more" not in said.split("Note")[1]


def test_a_force_that_was_averaged_has_no_ratio_to_a_noise() -> None:
    found = diagnose_motion([recording(1.0, window=40)])
    said = " ".join(motion_account(found).split())
    assert "moving average over 80" in said
    assert "is not known, because the recorded force was averaged" in said
    assert "times the noise" not in said
    document = json.loads(as_json(found.diagnosis))
    assert document["fit"]["training"]["force"]["noise"] is None
    assert document["explained"]["times_noise"] == {}
    assert not document["explained"]["complete"]
    assert "as the sensor gives it" in found.sentences.next_recording


def test_the_page_says_the_same_in_the_same_order(found: Found, tmp_path: Path) -> None:
    page, figures, document = write_motion_given(found, tmp_path)
    shown = " ".join(unescape(page.read_text(encoding="utf-8")).replace("\N{NO-BREAK SPACE}", " ").split())
    told = found.sentences
    said = [told.explained, *told.parts, told.remains, told.next_recording, *found.diagnosis.remarks]
    places = [shown.index(sentence) for sentence in said]
    assert places == sorted(places)
    assert "$" not in shown.split("</style>")[1].split("<script")[0]
    assert json.loads(document.read_text())["summary"] and (figures / "law.png").is_file()


def test_its_tables_have_every_part_of_the_law_and_every_test(found: Found) -> None:
    parts = {(row[1]): row[2] for row in effect_table(found).rows}
    assert set(parts) >= {"force", "damping"}
    value = float(parts["damping"].split()[0])
    assert value == pytest.approx(900.0, rel=0.02)
    names = [row[0] for row in error_table(found).rows]
    assert names == ["fitted recordings", "test: other.csv", "test: third.csv"]
    deviation, law = (float(error_table(found).rows[1][place].split()[0]) for place in (1, 2))
    assert deviation == pytest.approx(float(np.std(recording(-0.6).channels["force"].values)), rel=0.01)
    assert law < 6.0


def test_the_page_of_a_law_that_does_not_hold_says_so_first() -> None:
    generator = np.random.default_rng(2)
    rough = recording(1.0)
    force = rough.channels["force"]
    noisy = 300.0 * np.repeat(generator.standard_normal(200), 20)
    loud = replace(rough, channels={**rough.channels, "force": replace(force, values=force.values + noisy)})
    found = diagnose_motion([loud])
    assert not found.law.holds
    assert "No law holds" in motion_page(found).split("<h1>")[0].split("<body>")[1]
