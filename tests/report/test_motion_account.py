"""What is printed of a law of given motion: certain, remains, next, each test, and every remark as a whole."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from eha_core.motion_given import Found, diagnose_motion
from eha_core.recording import Recording
from eha_core.report.document import as_json
from eha_core.report.motion_account import motion_account

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
